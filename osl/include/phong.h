// Phong's and Blinn's lobes as in addon/reference/phong.py
#include "phong_table.h"

// max(a . b, 0)^n by the tangent: a cosine near 1 has few digits, and a high power loses those
float cosine_power(vector a, vector b, float n)
{
    float cosine = dot(a, b);
    if (cosine <= 1e-4) return n > 0 ? 0 : cosine > 0;
    vector across = a - cosine * b;
    float tan2 = dot(across, across) / (cosine * cosine), y = tan2 / (2 + tan2), y2 = y * y;
    return exp(-0.5 * n * (tan2 < 0.1 ? y * (2 + y2 * (2.0 / 3 + y2 * 0.4)) : log(1 + tan2)));
}

vector mirrored(normal N0, vector wo)
{
    return 2 * dot(N0, wo) * N0 - wo;
}

// Of Blinn-Phong: 2^(-n/2) + n
float blinn_over(float n)
{
    return exp2(-n / 2) + n;
}

// The lobe in 1/sr, of albedo 1 head-on
float cosine_lobe(normal N0, vector wi, vector wo, float n)
{
    if (ROUND) return (n + 2) / M_2PI * cosine_power(wi, mirrored(N0, wo), n);
    return (n + 2) * (n + 4) / (8 * M_PI * blinn_over(n)) * cosine_power(normalize(wi + wo), N0, n);
}

// m of the Beckmann lobe that is as wide near its peak
float as_wide(float n)
{
    return ROUND ? 1 / sqrt(2 * n + 1) : sqrt(2 / (n + 2));
}

// Cycles' lobe in place of it, as the viewer sees it, and Lambert's part of its light: addon/reference/phong_fit.py
void native_lobe_of(normal N0, vector wo, float n, output float weight, output float lambert, output normal lean,
                    output vector T, output float across, output float within)
{
    float c = max(dot(N0, wo), 0), m = as_wide(n), slope = m * (1 - NARROWER * m), slope2 = slope * slope;
    vector aside = wo - c * N0, B;
    float s2 = dot(aside, aside), k = 2 * slope2 / (c + sqrt(c * c + 8 * slope2 * s2));
    lean = normalize(N0 + k * aside);
    within = slope / sqrt(1 + 2 * slope2 * s2 / pow(c + 2 * k * s2, 2));
    across = ROUND ? min(slope * sqrt(1 + k * k * s2) / (c + k * s2), 1) : slope;
    T = cross(N0, wo);
    if (dot(T, T) > 1e-12)
        T = normalize(T);
    else
        tangents(N0, T, B);  // head-on lobes are round
    float q = 0.5 * (c + sqrt(c * c + KNEE * m * m));
    weight = max(fit_weight(q, m), 0);
    lambert = LAMBERT * m * m * m * max(fit_energy(q, m), 0);
}

// tan of the angle whose density over solid angle is cos^(power - 1): cos = (1 - u)^(1/power)
float steep(float u, float power)
{
    return sqrt(expm1(-2 * log(max(1 - u, 1e-7)) / power));  // the hash may round to 1
}

// A facet for each sample, and the weight lobe cos / density of the wi that it mirrors to
vector drawn_facet(normal N0, vector wo, float n, vector seed, output float weight)
{
    vector T, B;
    if (ROUND) {
        vector R = mirrored(N0, wo);
        tangents(R, T, B);
        float tangent = steep(random_number(STREAM_DIRECTION_RADIUS, seed), n + 1);
        float phi = M_2PI * random_number(STREAM_DIRECTION_AZIMUTH, seed);
        vector wi = normalize(R + tangent * (cos(phi) * T + sin(phi) * B));
        weight = (n + 2) / (n + 1) * max(dot(N0, wi), 0);
        return normalize(wi + wo);
    }
    tangents(N0, T, B);
    float tangent = steep(random_number(STREAM_FACET_SLOPE, seed), n + 2);
    float phi = M_2PI * random_number(STREAM_FACET_AZIMUTH, seed);
    vector aside = tangent * (cos(phi) * T + sin(phi) * B);
    vector h = normalize(N0 + aside), dual = normalize(N0 - aside);  // the two sides of a groove: Heitz & d'Eon 2014
    float seen = max(0, dot(wo, h)), dual_seen = max(0, dot(wo, dual));
    if (random_number(STREAM_FACET_DUAL, seed) * (seen + dual_seen) >= seen) {
        h = dual;
        seen = dual_seen;
    }
    vector wi = 2 * seen * h - wo;
    weight = (n + 4) / blinn_over(n) * max(dot(N0, wi), 0) * max(dot(N0, wo), seen / (2 * dot(N0, h)));
    return h;
}
