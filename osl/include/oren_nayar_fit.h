// SPDX-License-Identifier: GPL-3.0-or-later
// The mixture of estimator "fit": addon/reference/oren_nayar_fit.py, with its table
#include "oren_nayar_fit_table.h"
#define FIT_A (1 / (M_PI + M_PI_2 - 2.0 / 3))  // of Cycles' Oren-Nayar at roughness 1

// tan(theta_o/2)
float fit_x(normal n, vector wo)
{
    float mu = clamp(dot(n, wo), 0, 1);
    return sqrt((1 - mu) / (1 + mu));
}

// Colours of Lambert and of Cycles' Oren-Nayar of roughness 1; kept: the share of both that is left
void fit_colors(int kind, float x, float kept, color albedo, float sigma, output color lambert, output color retro)
{
    float s2 = sigma * sigma, facing = s2 / (s2 + 0.09);
    color once = 1 - 0.5 * s2 / (s2 + 0.33) + facing * fit_albedo(kind, x);
    if (kind == 0) once += albedo * (0.17 * s2 / (s2 + 0.13));
    color energy = min(albedo * once, color(1));

    retro = albedo * (facing * fit_retro(kind, x));
    float single = fit_native(kind, x);
    color again = FIT_POWER(retro) * (FIT_MEAN * (1 - single)) / (1 - retro * (1 - FIT_MEAN));
    lambert = kept * max(energy - (retro * single + again), color(0));
    retro *= kept;
}

// c of hybrid, which keeps what it has too much of below the bound
float fit_share(int kind, float x, float sigma, float bound)
{
    float s2 = sigma * sigma;
    return clamp(fit_share_at(kind, 2 * x - 1, 2 * s2 / (s2 + 0.09) - 1, bound), 0, 1);
}

// Albedo of one bounce in Cycles' Oren-Nayar of roughness 1
float fujii_albedo(float c, float s)
{
    float grazing = s * c * (1 + s + s * s) / (1 + s), angle = 2 * atan(s / (1 + c));
    return FIT_A * (M_PI + s * (angle - s * c) + 2.0 / 3 * (grazing - s));
}

// Cycles' Oren-Nayar of roughness 1; 0 where the light is below the surface
color cycles_diffuse(vector wi, vector wo, normal n, color c)
{
    float ni = dot(n, wi), view = dot(n, wo), no = max(view, 0);  // Cycles takes n.v as 0 where a map turns n away
    if (ni <= 0) return color(0);
    vector across_i = wi - ni * n, across_o = wo - view * n;
    float s = dot(across_i, across_o) + ni * min(view, 0), once = FIT_A * (1 + (s > 0 ? s / max(ni, no) : s));
    float lost = (1 - fujii_albedo(ni, length(across_i))) * (1 - fujii_albedo(no, length(across_o)));
    color again = FIT_POWER(c) * (FIT_MEAN / (1 - FIT_MEAN) * lost / M_PI) / (1 - c * (1 - FIT_MEAN));
    return c * once + again;
}

// f of both closures
color fit_mixture(vector wi, vector wo, normal n, color lambert, color retro)
{
    if (dot(n, wi) <= 0) return color(0);
    return lambert / M_PI + cycles_diffuse(wi, wo, n, retro);
}
