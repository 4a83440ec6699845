#pragma once
// A table as HTML.

#include <string>
#include <vector>

namespace puckloop::gap::report {

class Table {
  public:
    /// Column heads; one that begins with '#' holds numbers (set right).
    explicit Table(std::vector<std::string> heads);

    /// Cells are texts, escaped here. `style` is a class for the row ("strong", "faint") or empty.
    void row(const std::vector<std::string>& cells, const std::string& style = {});
    bool empty() const { return rows_ == 0; }
    std::string html() const;

  private:
    std::vector<std::string> heads_;
    std::string body_;
    std::size_t rows_ = 0;
};

/// Digits by which a value and the ends of its narrow interval read differently: four or more.
int digits_to_tell(double low, double value, double high);
/// A number for a table: four digits or more; "–" for NaN.
std::string cell(double value, int digits = 4);
/// A p value: "< 0.001" or three decimals.
std::string p_cell(double p);
/// "low .. high".
std::string range_cell(double low, double high, int digits = 4);

/// The unit of a column of numbers; nothing for pure ones.
std::string unit_cell(const std::string& unit);

}  // namespace puckloop::gap::report
