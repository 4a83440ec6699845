#include "gap/report/table.h"

#include "base/pages/svg.h"
#include "gap/stats/profile.h"

#include <fmt/format.h>

#include <cmath>

namespace puckloop::gap::report {

Table::Table(std::vector<std::string> heads) : heads_(std::move(heads)) {}

void Table::row(const std::vector<std::string>& cells, const std::string& style) {
    body_ += style.empty() ? "<tr>" : fmt::format("<tr class=\"{}\">", style);
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const bool number = i < heads_.size() && heads_[i].starts_with('#');
        body_ += fmt::format("<td{}>{}</td>", number ? " class=\"n\"" : "", escaped(cells[i]));
    }
    body_ += "</tr>\n";
    ++rows_;
}

std::string Table::html() const {
    std::string out = "<table>\n<thead><tr>";
    for (const std::string& head : heads_) {
        const bool number = head.starts_with('#');
        out += fmt::format("<th{}>{}</th>", number ? " class=\"n\"" : "",
                           escaped(number ? head.substr(1) : head));
    }
    return out + "</tr></thead>\n<tbody>\n" + body_ + "</tbody></table>\n";
}

int digits_to_tell(double low, double value, double high) {
    constexpr int kUsual = 4;
    return kUsual + stats::more_digits(low, value, high,
                                       [](double one, int more) { return cell(one, kUsual + more); });
}

std::string cell(double value, int digits) {
    if (!std::isfinite(value)) return "–";
    return stats::plain(value, digits);
}

std::string p_cell(double p) {
    if (!std::isfinite(p)) return "–";
    return p < 0.001 ? "< 0.001" : fmt::format("{:.3f}", p);
}

std::string range_cell(double low, double high, int digits) {
    return fmt::format("{} … {}", cell(low, digits), cell(high, digits));
}

std::string unit_cell(const std::string& unit) {
    return unit == "1" ? "" : unit;
}

}  // namespace puckloop::gap::report
