// Ashikhmin & Shirley's model as in addon/reference/ashikhmin_shirley.py
#include "anisotropic.h"
#include "ashikhmin_shirley_fit.h"

// n_u along the tangent, n_v across it
float exponent_along(float n, float anisotropy)
{
    return max((n + 2) * (1 - 0.9 * anisotropy) - 2, 0);
}

float exponent_across(float n, float anisotropy)
{
    return (n + 2) / (1 - 0.9 * anisotropy) - 2;
}

// f cos of the highlight with F = 1: p(h) min(1, n.l / n.v) / (4 v.h). The power is taken from the facet's slopes
float ashikhmin_lobe(normal n0, vector T, vector B, vector wi, vector wo, float n_u, float n_v, output float vh)
{
    vector both = wi + wo, h = normalize(both);
    vh = length(both) / 2;  // dot(wo, h) would lose a hundredfold in float32 at grazing angles
    float nh = max(dot(n0, h), 1e-4), ni = dot(n0, wi), no = dot(n0, wo);
    if (ni <= 0 || no <= 0) return 0;
    float x = dot(T, h) / nh, y = dot(B, h) / nh, t2 = x * x + y * y, z = t2 / (2 + t2), z2 = z * z;
    float flat = t2 < 0.1 ? (2 + z2 * (2.0 / 3 + z2 * 0.4)) / (2 + t2) : log(1 + t2) / t2;
    float power = exp(-0.5 * (n_u * x * x + n_v * y * y) * flat);
    return sqrt((n_u + 1) * (n_v + 1)) * power / (8 * M_PI * max(vh, 1e-7)) * min(ni / no, 1);
}

// What enters the surface: 1 - (1 - c/2)^5
float entering(float cosine)
{
    float half_cosine = 0.5 * clamp(cosine, 0, 1);
    return half_cosine * (5 - half_cosine * (10 - half_cosine * (10 - half_cosine * (5 - half_cosine))));
}

// Of the diffuse part Rd (1 - Rs), and pi f over that: 28/23 a(n.l) a(n.v). Over Lambert, of kind 1, Rd and 1
color deep(int kind, color albedo, color specular)
{
    return kind == 1 ? albedo : albedo * (1 - specular);
}

float scattered(int kind, float ni, float no)
{
    return kind == 1 ? 1 : 28.0 / 23 * entering(ni) * entering(no);
}

// What enters toward the viewer, of Rd
color entered(int kind, color albedo, color specular, float no)
{
    return deep(kind, albedo, specular) * (kind == 1 ? 1 : entering(no));
}

// A facet by p(h): the paper's section 4.1
vector ashikhmin_facet(normal n0, vector T, vector B, float n_u, float n_v, vector seed)
{
    float phi = M_2PI * random_number(STREAM_FACET_AZIMUTH, seed);
    float a = cos(phi) / sqrt(n_u + 1), b = sin(phi) / sqrt(n_v + 1), r2 = a * a + b * b;
    float x = -2 * r2 * log(max(1 - random_number(STREAM_FACET_SLOPE, seed), 1e-7));  // the hash may round to 1
    float steep = sqrt(expm1(x) / r2);
    return normalize(n0 + steep * (a * T + b * B));
}

// Color of Cycles' own highlight, F0 of the Beckmann lobe and its weight: split of addon/reference/ashikhmin_shirley_fit.py
color split(color specular, color amplitude, float weight, float more, float flat, float rise, float mean, output color f0, output float part)
{
    float least = min(min(specular[0], specular[1]), specular[2]), most = max(1 - least, 1e-7);
    float highest = max(max(specular[0], specular[1]), specular[2]);
    float share = rise / (rise + COLORED * (highest - least) + 1e-6);
    f0 = 1 - (1 - specular) / most;
    float dimmest = min(min(amplitude[0], amplitude[1]), amplitude[2]);
    part = dimmest * most * share * weight;
    color fitted = specular - share * flat * (specular - least) + (1 - specular) * mix(mean, more, share);
    return dimmest * fitted + (amplitude - dimmest) * (specular + mean * (1 - specular));
}

// The Beckmann lobe's slopes along its tangent and across it, as Metallic BSDF makes them
void beckmann_slopes(normal n0, float roughness, float lean, vector axis, output vector along, output float wide, output float narrow)
{
    float square = roughness * roughness, aspect = sqrt(1 - 0.9 * lean);
    along = normalize(axis - dot(axis, n0) * n0);
    wide = min(square / aspect, 1);
    narrow = min(square * aspect, 1);
}

// Cycles' own Ashikhmin-Shirley, without F
closure color native_ashikhmin(normal n0, vector T, float n_u, float n_v)
{
    return microfacet("ashikhmin_shirley", n0, T, sqrt(2 / (n_u + 2)), sqrt(2 / (n_v + 2)), 1, 0);
}
