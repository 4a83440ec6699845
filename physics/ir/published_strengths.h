#pragma once
// Medians and spreads of the strength measured between two range-and-bearing boards (argos3-epuck), which the
// infra-red medium's default curve reproduces.

#include <array>

namespace puckloop::physics {

struct PublishedStrength {
    double distance;    ///< m between the bodies
    double log_median;  ///< ln of the range register, counts
    double spread;      ///< sd of it
};
inline constexpr std::array<PublishedStrength, 9> kPublishedStrengths{{{0.00, 7.64689, 0.357061},
                                                                       {0.02, 7.59652, 0.319231},
                                                                       {0.05, 7.24955, 0.192649},
                                                                       {0.10, 7.08464, 0.15294},
                                                                       {0.15, 6.9845, 0.109233},
                                                                       {0.30, 6.91745, 0.121653},
                                                                       {0.45, 6.82319, 0.153155},
                                                                       {0.60, 6.82855, 0.141843},
                                                                       {0.80, 6.82855, 0.141843}}};

}  // namespace puckloop::physics
