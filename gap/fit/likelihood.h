#pragma once
// What a row costs (minus log likelihood) given its innovation: Student's t, lapses, clipping, a dead zone,
// events; and how steeply.
//
// Deviation: the tails of innovations are Student's t also where the line or the level is filtered.

#include "gap/fit/filter.h"

#include <vector>

namespace puckloop::gap {

struct RowCosts {
    std::vector<double> cost;        ///< minus log likelihood, nats
    std::vector<double> innovation;  ///< standardised; of a clipped row the middle of what it may be
};

void row_costs(const Observable& observable, const Predicted& predicted, const NoiseParameters& noise,
               RowCosts& out);

/// The costs alone, of innovations already filtered.
void costs_of(const Observable& observable, const Predicted& predicted, const NoiseParameters& noise,
              const Innovations& innovations, std::vector<double>& cost);

/// Their weighted sum (`weights` empty: all 1). Logarithms of many rows are taken as one of their product.
double cost_sum(const Observable& observable, const Predicted& predicted, const NoiseParameters& noise,
                const Innovations& innovations, const std::vector<double>& weights);

/// Is a row's cost a function of its z and its scale alone (no lapses, no dead zone)?
bool is_simple(const Predicted& predicted);

/// How steeply each row's cost rises.
struct RowSlopes {
    std::vector<double> slope;      ///< first derivative by z
    std::vector<double> curvature;  ///< second, expected over rows where that is known
    std::vector<double> tail;  ///< of a plain row, by the ln of the degrees of freedom at fixed z; else 0
};
void slopes_of(const Observable& observable, const NoiseParameters& noise, const Innovations& innovations,
               RowSlopes& out);

/// Expected curvature of a row's cost by ln scale, ln degrees of freedom and both.
struct ScaleInformation {
    double scale = 0.0, tail = 0.0, both = 0.0;
};
ScaleInformation scale_information(const NoiseParameters& noise);

}  // namespace puckloop::gap
