#pragma once
// A model whose parameters are a struct of named numbers: what predicts reads `now.scale`, not the value at
// an index.

#include "gap/models/model.h"

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::gap {

template <class Numbers>
class ModelOf : public Model {
  protected:
    explicit ModelOf(const Numbers& others = {}) : others_(others) {}

    /// As add(), for a number of the struct.
    void number(double Numbers::*place, std::string name, std::string unit, double neutral) {
        places_.emplace_back(place, static_cast<std::size_t>(add(std::move(name), std::move(unit), neutral)));
    }
    /// `values` as parameters(); numbers that are no parameter stay as they were given.
    Numbers numbers(const std::vector<double>& values) const {
        Numbers all = others_;
        for (const auto& [place, parameter] : places_)
            all.*place = values[parameter];
        return all;
    }

  private:
    Numbers others_;
    std::vector<std::pair<double Numbers::*, std::size_t>> places_;
};

}  // namespace puckloop::gap
