#pragma once
// How errors follow each other while a term is learnt, in one number: readings carry a share of the error
// before them over, sums wander by a random walk under the noise of a row. Both are taken out by one linear
// recursion, which is the same for errors and for what a term would make of them.

#include <cstdint>
#include <span>
#include <vector>

namespace puckloop::gap {

struct ErrorsLaw {
    bool sums = false;
    double number = 0.0;  ///< carried share; of sums the walk's variance a row over the noise's
    double sd = 1.0;      ///< of an innovation; of sums of the noise
    double tail = 1000;   ///< degrees of freedom
};

/// Recursion of the rows: what each takes of the row before, and how large its innovation is.
class Whitening {
  public:
    /// `known`: 0 where a row says nothing. `starts`: 1 where a chain begins.
    Whitening(const ErrorsLaw& law, std::span<const char> known, std::span<const char> starts);

    /// In place: innovations over their sizes (in units of sd); 0 where a row says nothing.
    void apply(std::span<double> column) const;
    /// One over the size of a row's innovation; 0: the row says nothing.
    double scale(std::size_t row) const { return steps_[row].scale; }
    /// Sum of ln of these sizes.
    double log_sizes() const { return log_sizes_; }

  private:
    struct Step {
        double gain = 0.0;  // of the innovation, that the next rows keep
        double scale = 0.0;
        char begins = 0;
    };
    bool sums_;
    double carry_;
    std::vector<Step> steps_;
    double log_sizes_ = 0.0;
};

/// ln of Student's density at z of unit scale.
double student_log_density(double z, double tail);
/// The law under which these errors are likeliest, its size and tail fitted, numbers from a grid.
ErrorsLaw law_of(bool sums, std::span<const double> errors, std::span<const char> known,
                 std::span<const char> starts);
/// Minus log likelihood of each row; 0 where it says nothing.
std::vector<double> row_costs_of(const ErrorsLaw& law, std::span<const double> errors,
                                 std::span<const char> known, std::span<const char> starts);

}  // namespace puckloop::gap
