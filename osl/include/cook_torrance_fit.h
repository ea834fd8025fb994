// The mixture of lobes of estimator "fit": addon/reference/cook_torrance_fit.py, with its table
#include "cook_torrance_fit_table.h"

struct Lobe {
    float weight, across, within;  // slopes to the plane of view
    normal n;
};

// x = m s / (c + m s): 0 head-on, 1 at grazing
void fit_lobes(normal n, vector wo, float slope, output Lobe lobes[FIT_LOBES])
{
    float m = min(slope, 1), c = dot(n, wo);
    vector aside = wo - c * n;
    float ms = m * length(aside), x = ms / max(max(c, 0) + ms, 1e-20);
    vector weight = fit_weight(x, m), anisotropy = x * fit_anisotropy(x, m), tilt = fit_tilt(x, m);
    float across = min(m * fit_across(x, m), 1);
    vector lean = m * (1 - x) * aside;
    for (int k = 0; k < FIT_LOBES; ++k) {
        lobes[k].weight = max(weight[k], 0);
        lobes[k].across = across;
        lobes[k].within = across * (1 - 0.9 * clamp(anisotropy[k], 0, 1));
        lobes[k].n = normalize(n - tilt[k] * lean);
    }
}
