#pragma once
// Rows of an experiment gathered for a model: columns side by side, chains in order, rows without truth left
// out.

#include "gap/data/experiment.h"
#include "gap/models/model.h"

#include <initializer_list>
#include <string_view>
#include <vector>

namespace puckloop::gap {

/// Rows of all runs that have every needed column, a chain (a run and one value of `chain_by`) after another.
class Rows {
  public:
    /// `chain_by` may be "" (a run is a chain).
    Rows(const Experiment& experiment, std::string_view chain_by,
         const std::vector<std::string_view>& needed);

    std::size_t size() const { return run_.size(); }
    /// The column in these rows; `fallback` where it is missing.
    std::vector<double> column(std::string_view name, double fallback) const;
    /// A column, where it goes to, and what it is where it is missing.
    struct Wanted {
        std::vector<double>& into;
        std::string_view name;
        double fallback = 0.0;
    };
    /// An observable of the column, rows without it left out: fills y, run, row, starts, steps, time, and the
    /// columns `beside` it. A sum (Level) goes on over gaps. Rows that are missing are counted by `seq`, else
    /// by time where a run keeps to a beat. Its quantum is the instrument's, else what the values keep to.
    /// Rows where `skipped` is above a half are left out, too. `places` receives where its rows are in these
    /// rows.
    Observable observable(std::string_view name, NoiseKind noise, std::initializer_list<Wanted> beside,
                          const std::vector<double>& skipped = {},
                          std::vector<std::uint32_t>* places = nullptr) const;

  private:
    /// Time between rows of a run: runs have rates of their own.
    struct Beat {
        double usual = 0.0;  ///< s; 0: no times are known
        bool kept = false;   ///< nearly all steps are whole multiples of it
    };
    std::vector<Beat> beats(const std::vector<double>& time) const;

    const Experiment& experiment_;
    std::vector<std::uint32_t> run_, row_;
    std::vector<std::uint32_t> place_;  ///< in its chain, rows left out counted
    std::vector<char> starts_;
};

/// Values of `column` at the places `used`.
std::vector<double> taken(const std::vector<double>& column, const std::vector<std::uint32_t>& used);

/// The different values of a column, rising.
std::vector<double> distinct(const std::vector<double>& column);

/// Numbers of sensors and the like, rounded.
std::vector<int> whole(const std::vector<double>& column);
/// The different ones, each where it was met first.
std::vector<int> in_order_met(const std::vector<int>& numbers);

}  // namespace puckloop::gap
