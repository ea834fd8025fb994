// (cos, sin) of an angle in degrees. Whole degrees and binary fractions are exact in float32, so the angle is
// brought within 45 degrees before it is rounded to radians; then by series, as OSL's own sin() rounds to 6e-8
// absolute. Together cosines keep their relative precision at grazing angles.
void turn(float degrees, output float cosine, output float sine)
{
    float quarter = floor(degrees / 90 + 0.5);
    float x = radians(degrees - 90 * quarter), x2 = x * x;
    float s = x * (1 - x2 / 6 * (1 - x2 / 20 * (1 - x2 / 42 * (1 - x2 / 72))));
    float c = 1 - x2 / 2 * (1 - x2 / 12 * (1 - x2 / 30 * (1 - x2 / 56 * (1 - x2 / 90))));
    int q = (int)mod(quarter, 4);
    cosine = q == 0 ? c : q == 1 ? -s : q == 2 ? -c : s;
    sine = q == 0 ? s : q == 1 ? c : q == 2 ? -s : -c;
}
