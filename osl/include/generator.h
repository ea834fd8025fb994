// Facets of any distribution as in addon/reference/facet_distribution.py

// log(1 + x), by a series where 1 + x would round
float log_one_more(float x)
{
    float y = x / (2 + x), y2 = y * y;
    return x < 0.1 ? y * (2 + y2 * (2.0 / 3 + y2 * 0.4)) : log(1 + x);
}

#include "facet_distribution.h"
