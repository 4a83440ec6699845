#pragma once
// A table as numbers that may be learnt: places along one covariate or two, straight lines between them, and
// a Gaussian process's prior over the values at the places (Matern 3/2 in how many rows lie between), as the
// root of its covariance.

#include "gap/extension/subjects.h"

#include <Eigen/Dense>

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

/// The part of a row's term that each value of a table makes: at most four of them.
struct RowWeights {
    std::array<std::size_t, 4> at{};
    std::array<double, 4> weight{};  ///< 0: none
};

class TableBasis {
  public:
    /// Places are laid by the rows in `used`.
    TableBasis(const Subject& subject, const TableShape& shape, const std::vector<char>& used);

    const TableShape& shape() const { return shape_; }
    const std::vector<std::vector<double>>& places() const { return places_; }
    std::size_t values() const { return values_; }  ///< of one table
    std::size_t tables() const { return tables_; }  ///< sensors, runs, or one
    bool empty() const { return values_ == 0; }

    /// Of row i of a subject of the same covariates; the index of its table apart. A run that was not used
    /// has no table: no weights.
    RowWeights row(const Subject& subject, std::size_t i) const;
    std::size_t table_of(const Subject& subject, std::size_t i) const;

    /// values = root * z, z independent of unit size. `length`: of the kernel, in shares of an axis.
    Eigen::MatrixXd root(double length) const;

  private:
    void lay_places(const Subject& subject, const std::vector<char>& used);

    TableShape shape_;
    std::vector<std::vector<double>> places_;
    std::vector<char> periodic_;
    std::size_t values_ = 1, tables_ = 1;
};

}  // namespace puckloop::gap
