// SPDX-License-Identifier: GPL-3.0-or-later
// D, G and F as in addon/reference; shared by the shaders, and written into their text when a material is made.
#include "random_numbers.h"
#include "versions.h"

// Walter et al. 2007, eq. 25
float beckmann_d(vector h, normal n, float m)
{
    float nh = dot(n, h);
    if (nh < 1e-4) return 0;  // exp(-1e8 / m^2) is 0
    vector tangential = h - nh * n;  // sin^2 by components: 1 - nh * nh cancels in float32
    float nh2 = nh * nh;
    return exp(-dot(tangential, tangential) / (nh2 * m * m)) / (M_PI * m * m * nh2 * nh2);
}

// Cook & Torrance 1982
float vgroove_g(float nh, float nv, float nl, float vh)
{
    return min(1, 2 * nh * min(nv, nl) / vh);
}

// What is refracted: max(G1(v) + G1(l) - 1, 0), with g = eta |l.h| and eta |n.l| = n.v + (g - v.h) (n.h)
float vgroove_g_below(float nh, float nv, float vh, float G1, float eta)
{
    float beyond = (eta - 1) * (eta + 1);
    float g = sqrt(max(0, vh * vh + beyond));
    float below = max(0, nv + nh * beyond / max(g + vh, 1e-7));
    return max(0, G1 - (1 - min(1, 2 * nh * below / max(g, 1e-7))));
}

// Schlick 1994, eq. 15
color schlick(float cosine, color f0)
{
    float x = 1 - clamp(cosine, 0, 1), x2 = x * x;
    return f0 + (1 - f0) * (x2 * x2 * x);
}

// Kutz, Hasan & Edmondson 2021: Schlick's formula, multiplied by tint where the cosine is 1/7
color f82(float cosine, color f0, color tint)
{
    float at = 1.0 / 7, c = clamp(cosine, 0, 1), x = 1 - c, x2 = x * x;
    color b = schlick(at, f0) * (1 - tint) / (at * pow(1 - at, 6));
    return max(schlick(c, f0) - b * (c * x2 * x2 * x2), color(0));
}

// Cook & Torrance 1982; g = 0 in total internal reflection, which gives 1
float fresnel_dielectric(float cosine, float eta)
{
    float c = clamp(cosine, 1e-7, 1);  // at 0 exactly, total reflection would read 0/0
    float g = sqrt(max(0, c * c + (eta - 1) * (eta + 1)));
    float s = (g - c) / (g + c);
    float p = (c * (g + c) - 1) / (c * (g - c) + 1);
    return 0.5 * s * s * (1 + p * p);
}

// The IOR that Cycles' refracting closures are to be given: of what lies ahead, but where they turn it over themselves
float closure_ior(float eta)
{
    return backfacing() && !CYCLES_TURNS_IOR ? 1 / eta : eta;
}

// A thin loss-less sheet: both faces, with all reflections between them
float pane(float F)
{
    return 2 * F / (1 + F);
}

// Born & Wolf 14.2; A = |g|^2 and a = Re g of g^2 = (n + ik)^2 - sin^2
color fresnel_conductor(float cosine, color n, color k)
{
    float c = clamp(cosine, 0, 1), c2 = c * c, s2 = 1 - c2;
    color real = (n - k) * (n + k) - s2;
    color A = sqrt(real * real + 4 * n * n * k * k);
    color ac = sqrt(max(0.5 * (A + real), color(0))) * c;
    color rs = (A + c2 - 2 * ac) / (A + c2 + 2 * ac);
    color rp = rs * (A * c2 + s2 * s2 - 2 * ac * s2) / (A * c2 + s2 * s2 + 2 * ac * s2);
    return 0.5 * (rs + rp);
}

// kind: 0 Schlick (f0), 1 dielectric (eta), 2 conductor (n, k), 3 F82 (f0, f82_tint); constant, so the compiler keeps
// one branch
color fresnel(int kind, float cosine, color f0, color f82_tint, float eta, color n, color k)
{
    if (kind == 0) return schlick(cosine, f0);
    if (kind == 1) return color(fresnel_dielectric(cosine, eta));
    if (kind == 3) return f82(cosine, f0, f82_tint);
    return fresnel_conductor(cosine, n, k);
}

// Cycles' Beckmann lobe with slope at along T and ab across it
closure color native_lobe(
    int kind, normal Normal, vector T, float at, float ab, color f0, color f82_tint, float eta, color n, color k)
{
    if (kind == 0)
        return generalized_schlick_bsdf(Normal, T, color(1), color(0), at, ab, f0, color(1), 5.0, "beckmann");
    if (kind == 1) return dielectric_bsdf(Normal, T, color(1), color(0), at, ab, eta, "beckmann");
    if (kind == 3) return microfacet_f82_tint("beckmann", Normal, T, at, ab, f0, f82_tint);
    return conductor_bsdf(Normal, T, at, ab, n, k, "beckmann");
}

// The surface's own normal where none is linked: an unlinked group input reads (0, 0, 0)
normal shading_normal(normal given)
{
    normal held = clamp(given, normal(-1e15), normal(1e15));  // the square of more is infinite
    return dot(held, held) > 1e-12 ? normalize(held) : N;
}

// The same for closures that mirror, raised toward Ng until the view's mirror image is above the surface: N + k Ng, as
// nodegroups/shading_normal.py derives it; not on hair, whose ribbons face the viewer while N goes around it
normal specular_normal(normal given)
{
    normal n = shading_normal(given);
    float c = dot(Ng, I), d = dot(n, Ng), no = dot(n, I), t = min(0.9 * c, 0.01);
    if (2 * no * d - c >= t) return n;
    float on_hair = 0;
    getattribute("geom:is_curve", on_hair);
    if (on_hair) return n;
    float u = no - d * c, k = (sqrt(u * u + (1 - d * d) * (c * c - t * t)) - u) / (c - t) - d;
    return normalize(n + k * Ng);
}

// Squared slope of Cycles' bump smoothing, from the tilt of a linked normal; 0 where none is linked
float bump_slope2(normal given, normal n)
{
    float d = dot(n, N);
    return dot(given, given) > 1e-12 ? clamp(0.125 * (1 / max(d * d, 1e-12) - 1), 0, 1) : 0;
}

// Whether a light is above the surface without the map, which Cycles asks of every closure
int bump_lit(normal given, normal n, vector wi)
{
    return dot(given, given) <= 1e-12 || dot(N, wi) * dot(N, n) > 0;
}

// The share of light from wi that Cycles' diffuse closures keep on a mapped normal. Conty Estevez et al. 2019
float bump_smoothing(normal given, normal n, vector wi)
{
    float light = dot(N, wi), slope2 = bump_slope2(given, n);
    return bump_lit(given, n, wi) ? 2 / (1 + sqrt(1 + slope2 * (1 / max(light * light, 1e-12) - 1))) : 0;
}

// Its average in an even light, as in nodegroups/shading_normal.py
float bump_average(normal given, normal n)
{
    return 1 / (1 + 0.62 * pow(bump_slope2(given, n), 0.75));
}

// Two unit vectors at right angles to the unit vector n and to each other
void tangents(vector n, output vector T, output vector B)
{
    T = normalize(cross(n, n[2] * n[2] < 0.8 ? vector(0, 0, 1) : vector(1, 0, 0)));
    B = cross(n, T);
}

// Random numbers from the scene's seed, position, place on the triangle and direction, of which every sample and bounce
// moves some. Each number has a stream, listed in nodegroups/random_numbers.py
float random_number(float stream, vector seed)
{
    float w = noise("hash", I, noise("hash", seed, stream));
    w = noise("hash", point(1 - u - v, u, 0), w);
    return noise("hash", P, w);
}

// A facet by D(h) (n.h), swapped for its dual across the groove where the view rather sees that. Heitz & d'Eon 2014
vector visible_facet(normal n0, vector wo, float m, vector seed)
{
    vector T, B;
    tangents(n0, T, B);
    float slope = m * sqrt(-log(max(1 - random_number(STREAM_FACET_SLOPE, seed), 1e-7)));  // the hash may round to 1
    float phi = M_2PI * random_number(STREAM_FACET_AZIMUTH, seed);
    vector lean = slope * (cos(phi) * T + sin(phi) * B);
    vector h = normalize(n0 + lean), dual = normalize(n0 - lean);
    float seen = max(0, dot(wo, h)), dual_seen = max(0, dot(wo, dual));
    return random_number(STREAM_FACET_DUAL, seed) * (seen + dual_seen) >= seen ? dual : h;
}
