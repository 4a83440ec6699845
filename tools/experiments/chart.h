#pragma once
// A plain chart with two linear axes as SVG: bands, lines, dots, marks.

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace puckloop::tools {

struct Axis {
    double low = 0.0, high = 1.0, step = 1.0;
    std::string title;
};

class Chart {
  public:
    using Points = std::vector<std::pair<double, double>>;

    /// `square`: one unit is as long on both axes.
    Chart(const std::string& title, const std::string& caption, Axis x, Axis y, bool square = false);

    void line(const Points& points, std::string_view colour, std::string_view style = {});
    void band(const Points& low, const Points& high, std::string_view colour);
    void dots(const Points& points, std::string_view colour, double radius = 2.5);
    /// A horizontal line with its name.
    void level(double y, const std::string& name);
    void text(double x, double y, const std::string& words, std::string_view style = {});

    std::string document() const;

  private:
    double px(double x) const;
    double py(double y) const;
    std::string joined(const Points& points) const;

    Axis x_, y_;
    double width_, height_;
    std::string svg_;
};

}  // namespace puckloop::tools
