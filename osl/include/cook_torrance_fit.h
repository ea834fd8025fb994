// The mixture of lobes of estimator "fit": addon/reference/cook_torrance_fit.py, with its table
#include "cook_torrance_fit_table.h"

struct Lobe {
    float weight, across, within;  // slopes to the plane of view
    normal n;
};

// x = m s / (c + m s): 0 head-on, 1 at grazing
float fit_x(normal n, vector wo, float m)
{
    float c = dot(n, wo), ms = m * length(wo - c * n);
    return ms / max(max(c, 0) + ms, 1e-20);
}

// c of hybrid, which keeps what it has too much of below the bound
float fit_share(normal n, vector wo, float slope, float bound)
{
    float m = min(slope, 1);
    return clamp(fit_share_at(2 * fit_x(n, wo, m) - 1, 2 * m - 1, bound), 0, 1);
}

// From the table's numbers: of the first lobe the roughness, of the others also anisotropy and tilt
void fit_lobes(normal n, vector wo, vector weights, float first, vector second, vector third,
               output Lobe lobes[FIT_LOBES])
{
    vector of[FIT_LOBES] = {vector(first, 0, 0), second, third};
    for (int k = 0; k < FIT_LOBES; ++k) {
        float square = of[k][0] * of[k][0], aspect = sqrt(1 - 0.9 * of[k][1]);
        lobes[k].weight = weights[k];
        lobes[k].across = min(square / aspect, 1);
        lobes[k].within = min(square * aspect, 1);
        lobes[k].n = normalize(n - of[k][2] * wo);
    }
}

// Smith's Lambda of a Beckmann lobe; a = 1 / (slope tan)
float smith_lambda(vector w, float ax, float ay)
{
    float slope = hypot(w[0] * ax, w[1] * ay) / w[2], a = 1 / max(slope, 0.625);
    return slope > 0.625 ? (1 - 1.259 * a + 0.396 * a * a) / (3.535 * a + 2.181 * a * a) : 0;
}

// D G / (4 v.n) of an anisotropic lobe. Heitz 2014, eqs. 85 to 99
float smith_lobe(vector wi, vector wo, vector h, vector T, Lobe lobe)
{
    vector n = lobe.n, B = cross(n, T);
    vector i = vector(dot(wi, T), dot(wi, B), dot(wi, n));
    vector o = vector(dot(wo, T), dot(wo, B), dot(wo, n));
    vector f = vector(dot(h, T), dot(h, B), dot(h, n));
    float ax = lobe.across, ay = lobe.within;
    if (i[2] <= 0 || o[2] <= 0 || f[2] < 1e-4) return 0;
    float x = f[0] / (f[2] * ax), y = f[1] / (f[2] * ay), nh2 = f[2] * f[2];
    float D = exp(-x * x - y * y) / (M_PI * ax * ay * nh2 * nh2);
    return D / ((1 + smith_lambda(i, ax, ay) + smith_lambda(o, ax, ay)) * 4 * o[2]);
}

// f cos of the mixture with F = 1
float fit_mixture(vector wi, vector wo, vector h, normal n, Lobe lobes[FIT_LOBES])
{
    vector T = cross(n, wo), B;
    if (dot(T, T) > 1e-12)
        T = normalize(T);
    else
        tangents(n, T, B);  // head-on lobes are round
    float sum = 0;
    for (int k = 0; k < FIT_LOBES; ++k)
        sum += lobes[k].weight * smith_lobe(wi, wo, h, T, lobes[k]);
    return sum;
}
