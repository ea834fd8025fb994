// SPDX-License-Identifier: GPL-3.0-or-later
// Oren & Nayar 1994 as in addon/reference/oren_nayar.py

// 2/pi of the angle above the horizon, whose half has the tangent cos/(1 + sin)
float elevation(float cosine, float sine)
{
    return 4 / M_PI * atan(cosine / (1 + sine));
}

// Eqs. 27 to 30, in 1/sr; 0 where the light is below the surface. kind: 0 full, 1 qualitative
color oren_nayar(int kind, vector wi, vector wo, normal n, color albedo, float sigma)
{
    float ni = dot(n, wi), view = dot(n, wo), no = max(view, 1e-7);  // a map may turn n away: a grazing view
    if (ni <= 0) return color(0);
    vector across_i = wi - ni * n, across_o = wo - view * n;  // sin by components: 1 - ni * ni cancels in float32
    float sin_i = length(across_i), sin_o = length(across_o);
    // Along the normal 0 / 0 reads 0 in OSL; b is 0 there and every factor of cos p vanishes with it.
    float cos_p = clamp(dot(across_i, across_o) / (sin_i * sin_o), -1, 1);
    float cos_a = min(ni, no), sin_a = max(sin_i, sin_o), cos_b = max(ni, no), tan_b = min(sin_i, sin_o) / cos_b;

    float s2 = sigma * sigma, facing = s2 / (s2 + 0.09);
    float C1 = 1 - 0.5 * s2 / (s2 + 0.33), C2 = 0.45 * facing * sin_a;
    if (kind == 1) return albedo / M_PI * (C1 + max(0, cos_p) * C2 * tan_b);

    // 1 - 2a/pi and 1 - 2b/pi keep their digits at grazing angles
    float x = elevation(cos_a, sin_a), y = elevation(cos_b, min(sin_i, sin_o));
    if (cos_p < 0)  // sin a - (2b/pi)^3
        C2 = 0.45 * facing * (y * (3 - y * (3 - y)) - cos_a * cos_a / (1 + sin_a));
    float C3 = 0.125 * facing * pow((1 - x) * (1 - y), 2);
    float once = C1 + cos_p * C2 * tan_b + (1 - abs(cos_p)) * C3 * (sin_i + sin_o) / (ni + no);
    float twice = 0.17 * s2 / (s2 + 0.13) * (1 - cos_p * pow(1 - y, 2));
    return albedo / M_PI * max(once + albedo * twice, color(0));  // the fit dips below 0 where both directions graze
}

// wi drawn by the cosine. Malley: a uniform disc projected up
vector cosine_direction(normal n, vector seed)
{
    vector T = normalize(cross(n, n[2] * n[2] < 0.8 ? vector(0, 0, 1) : vector(1, 0, 0)));
    vector B = cross(n, T);
    float disc = random_number(STREAM_DIRECTION_RADIUS, seed);
    float phi = M_2PI * random_number(STREAM_DIRECTION_AZIMUTH, seed);
    return sqrt(disc) * (cos(phi) * T + sin(phi) * B) + sqrt(1 - disc) * n;
}
