#pragma once
// A residual's course over a covariate: means in bins, and the course in words.

#include <string>
#include <string_view>
#include <vector>

namespace puckloop::gap::stats {

struct Profile {
    std::vector<double> x;      ///< mean covariate of each bin, ascending
    std::vector<double> y;      ///< mean residual
    std::vector<double> error;  ///< its standard error, from the scatter in the bin

    double range() const;  ///< largest minus smallest mean
};

/// Bins with about equal counts; few distinct covariate values (at most `levels`) are bins by themselves.
/// Bin number of every row, -1 where the covariate is not known; `count` receives how many there are.
std::vector<int> bins_of(const std::vector<double>& x, int& count, int bins = 8, int levels = 12);

/// Mean of the values at each of `count` places (a place a row, -1: none); NaN where there is none. Rows
/// without a value are left out.
std::vector<double> means_at(const std::vector<int>& place, int count, const std::vector<double>& values);

Profile profile_of(const std::vector<double>& x, const std::vector<double>& y, int bins = 8);

/// "grows with distance, zero at zero"; "steps up near speed 0.07"; "highest near angle 1.6"; "irregular over
/// ..."
std::string shape_words(const Profile& profile, std::string_view covariate);

/// A number as a person writes it: four significant digits, no exponent for everyday sizes.
std::string plain(double value, int digits = 4);

/// By how many digits more than usual, four at the most, the ends and the middle of a narrow interval read
/// differently. `read(value, more)`: a value as a text.
template <class Read>
int more_digits(double low, double middle, double high, const Read& read) {
    int more = 0;
    while (more < 4 && low < middle && middle < high &&
           (read(low, more) == read(middle, more) || read(middle, more) == read(high, more)))
        ++more;
    return more;
}

}  // namespace puckloop::gap::stats
