// SPDX-License-Identifier: GPL-3.0-or-later
// Random numbers from the position, which every sample and bounce moves; one hash stream a number
float random_number(float stream)
{
    return noise("hash", P, stream + noise("hash", I));
}
