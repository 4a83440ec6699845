#pragma once
// A model whose parameters are named numbers: those of the simulator, by its own table of names, units and
// defaults, and what the model has besides. What predicts reads `now.ground.black`, not the value at an
// index.

#include "gap/models/model.h"
#include "physics/description/parameters.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::gap {

/// The default of `Numbers` is the simulator without an effect. To have numbers of the simulator's it is
/// derived from physics::Parameters.
template <class Numbers>
class ModelOf : public Model {
  protected:
    /// A number that the simulator does not have, and the parameter that it is.
    struct Own {
        double Numbers::*place;
        std::string name;
        const char* unit;
    };
    /// As add(), one by one.
    void declare(std::initializer_list<Own> table) {
        for (const auto& [place, name, unit] : table)
            put(name, unit, [place = place](Numbers& all) { return &(all.*place); });
    }
    /// Place `k` of an array: a parameter called `name` with `number` behind it.
    template <class Array>
    void declare_part(Array Numbers::*array, std::size_t k, const std::string& name, int number,
                      const char* unit) {
        put(name + std::to_string(number), unit, [array, k](Numbers& all) { return &(all.*array)[k]; });
    }
    /// The simulator's parameters of these names in a group: "ground.", {"black", "gain2"}.
    void simulated(const std::string& group, std::initializer_list<std::string> names) {
        for (const std::string& one : names) {
            const std::string name = group + one;
            int index = -1;
            const physics::ParameterInfo* info = physics::find_parameter(name, index);
            if (info == nullptr) throw std::logic_error("the simulator has no parameter " + name);
            put(name, info->unit,
                [info, k = std::max(index, 0)](Numbers& all) { return info->place(all) + k; });
        }
    }
    /// Has no say with this experiment: a name that nothing asks for.
    void hide(std::string_view name) { parameter(name).name.insert(0, "-"); }
    /// `values` as parameters().
    Numbers numbers(const std::vector<double>& values) const {
        Numbers all = defaults_;
        for (const auto& [place, parameter] : places_)
            *place(all) = values[parameter];
        return all;
    }
    /// What the experiment says of the robot, else the simulator.
    Numbers nominal() const { return numbers(neutral()); }

  private:
    using Place = std::function<double*(Numbers&)>;
    void put(const std::string& name, const char* unit, Place place) {
        const double neutral = *place(defaults_);
        places_.emplace_back(std::move(place), add(name, unit, neutral));
    }

    Numbers defaults_;
    std::vector<std::pair<Place, std::size_t>> places_;
};

/// `values` of so many rows where they are `asked` for; else none, which is neutral.
template <class Value>
void fill_rows(std::vector<double>& values, std::size_t rows, bool asked, const Value& value) {
    values.resize(asked ? rows : 0);
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = value(i);
}

/// What something that warms up adds `time` s after power-up of `drift` in the end; `lasts`: s.
inline double warmed(double drift, double time, double lasts) {
    return drift == 0.0 ? 0.0 : drift * (1 - std::exp(-std::max(time, 0.0) / lasts));
}

}  // namespace puckloop::gap
