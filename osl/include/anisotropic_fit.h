// The stretched mixture of lobes of estimator "fit", as nodegroups/anisotropic_fit.py looks it up
#include "cook_torrance_fit.h"

// A lobe as Cycles' Metallic BSDF takes it, and its tangent at right angles to its own normal
void anisotropic_lobe(int at, float weight, float roughness, vector towards, float anisotropy, vector tangent,
                      output Lobe lobes[FIT_LOBES], output vector T[FIT_LOBES])
{
    float square = min(roughness * roughness, 1), aspect = sqrt(1 - 0.9 * anisotropy);
    lobes[at].weight = weight;
    lobes[at].across = min(square / aspect, 1);
    lobes[at].within = min(square * aspect, 1);
    lobes[at].n = normalize(towards);
    T[at] = normalize(tangent - dot(tangent, lobes[at].n) * lobes[at].n);
}
