// Facets with one slope along a tangent and another across it: D and the random facet of addon/reference
#include "vgroove.h"

// T along the tangent, turned about n by so many turns, and B across it; tangent is a unit vector along the surface
void anisotropic_axes(normal n, vector tangent, float rotation, output vector T, output vector B)
{
    vector across = normalize(cross(n, tangent)), along = cross(across, n);
    float angle = M_2PI * rotation;
    T = cos(angle) * along + sin(angle) * across;
    B = cross(n, T);
}

// s of slopes m / s along the tangent and m s across it
float anisotropic_aspect(float anisotropy)
{
    return sqrt(1 - 0.9 * anisotropy);
}

// Heitz 2014, eq. 80
float anisotropic_d(vector h, normal n, vector T, vector B, float m, float anisotropy)
{
    float nh = dot(n, h), aspect = anisotropic_aspect(anisotropy);
    if (nh < 1e-4) return 0;  // exp(-1e8 / m^2) is 0
    float x = dot(h, T) * aspect / (nh * m), y = dot(h, B) / (nh * m * aspect), nh2 = nh * nh;
    return exp(-x * x - y * y) / (M_PI * m * m * nh2 * nh2);
}

// As visible_facet of vgroove.h
vector anisotropic_facet(normal n0, vector wo, vector T, vector B, float m, float anisotropy, vector seed)
{
    float slope = m * sqrt(-log(max(1 - random_number(STREAM_FACET_SLOPE, seed), 1e-7)));  // the hash may round to 1
    float phi = M_2PI * random_number(STREAM_FACET_AZIMUTH, seed), aspect = anisotropic_aspect(anisotropy);
    vector lean = slope * (cos(phi) / aspect * T + sin(phi) * aspect * B);
    vector h = normalize(n0 + lean), dual = normalize(n0 - lean);
    float seen = max(0, dot(wo, h)), dual_seen = max(0, dot(wo, dual));
    return random_number(STREAM_FACET_DUAL, seed) * (seen + dual_seen) >= seen ? dual : h;
}
