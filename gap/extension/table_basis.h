#pragma once
// A table as numbers that may be learnt: places along one covariate or two, straight lines between them, and
// a Gaussian process's prior over the values at the places (Matern 3/2), as the root of its covariance. A way
// along an axis counts half by the covariate's range and half by the share of the rows that lies on it.

#include "gap/extension/subjects.h"

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace puckloop::gap {

/// Which table: over these covariates of a subject (none: one number), a share of `times` (-1: of 1), the
/// same for all sensors or one for each, or one number for each run.
struct TableShape {
    std::vector<std::size_t> over;
    int times = -1;
    bool by_sensor = false, by_run = false;

    bool operator==(const TableShape&) const = default;
};

/// The part of a moment's term that each value of a table makes: at most four of them.
struct MomentWeights {
    std::array<std::size_t, 4> at{};
    std::array<double, 4> weight{};  ///< 0: none
};

/// How smooth a table is.
struct Kernel {
    std::array<double, 2> lengths{1.0, 1.0};  ///< along each axis, in shares of it
    bool round = true;                        ///< both ends of an angle are one place
};

class TableBasis {
  public:
    /// `most` places along each axis, from end to end of all rows and laid by those in `used`: half by where
    /// they are, half by the range, so that neither a crowd nor a stray value takes them all.
    TableBasis(const Subject& subject, const TableShape& shape, const std::vector<char>& used,
               std::size_t most);

    const TableShape& shape() const { return shape_; }
    const std::vector<std::vector<double>>& places() const { return places_; }
    std::size_t values() const { return values_; }  ///< of one table
    std::size_t tables() const { return tables_; }  ///< sensors, runs, or one
    bool empty() const { return values_ == 0; }

    /// Calls `add(value, weight)` for all that make row i's term, of a subject of the same covariates; the
    /// index of its table apart.
    template <class Add>
    void of_row(const Subject& subject, std::size_t i, const Add& add) const {
        for (std::size_t m = subject.moments[i]; m < subject.moments[i + 1]; ++m) {
            const MomentWeights own = of_moment(subject, m);
            for (std::size_t c = 0; c < corners(); ++c)
                add(own.at[c], own.weight[c]);
        }
    }
    std::size_t table_of(const Subject& subject, std::size_t i) const;

    /// values = root * z, z independent of unit size.
    Eigen::MatrixXd root(const Kernel& kernel) const;
    bool goes_round() const { return std::ranges::find(periodic_, 1) != periodic_.end(); }

  private:
    std::size_t corners() const { return std::size_t{1} << places_.size(); }
    MomentWeights of_moment(const Subject& subject, std::size_t m) const;
    void lay_places(const Subject& subject, const std::vector<char>& used, std::size_t most);

    TableShape shape_;
    std::vector<std::vector<double>> places_, along_;  // and how far along its axis each is, 0 to 1
    std::vector<char> periodic_;
    std::size_t values_ = 1, tables_ = 1;
};

}  // namespace puckloop::gap
