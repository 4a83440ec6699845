#pragma once
// A small x-y chart as SVG text: grey grid, labelled axes with units, points, lines, bands. Made for print.

#include <string>
#include <vector>

namespace puckloop {

/// Ticks at 1, 2 or 5 times a power of ten that cover low..high with about `wanted` steps.
struct Scale {
    double low = 0.0, high = 1.0, step = 0.2;

    static Scale covering(double low, double high, int wanted = 5);
    std::vector<double> ticks() const;
    /// A tick's text with as many decimals as the step needs.
    std::string label(double tick) const;
};

class Chart {
  public:
    /// Axis texts with units: "distance (m)".
    Chart(std::string title, std::string x_label, std::string y_label);

    /// NaN values are left out. An empty name keeps a layer out of the legend. More than 1500 points are
    /// thinned evenly.
    void points(const std::vector<double>& x, const std::vector<double>& y, const std::string& colour,
                const std::string& name);
    void line(const std::vector<double>& x, const std::vector<double>& y, const std::string& colour,
              const std::string& name, bool dashed = false) {
        layers_.push_back({Layer::Kind::Line, x, y, {}, colour, name, dashed});
    }
    void band(const std::vector<double>& x, const std::vector<double>& low, const std::vector<double>& high,
              const std::string& colour) {
        layers_.push_back({Layer::Kind::Band, x, low, high, colour});
    }
    /// Every point, larger than points() draws them.
    void dots(const std::vector<double>& x, const std::vector<double>& y, const std::string& colour,
              const std::string& name = {}) {
        layers_.push_back({Layer::Kind::Dots, x, y, {}, colour, name});
    }
    /// A wide bar round each x from low to high, `half` to either side.
    void bars(const std::vector<double>& x, double half, const std::vector<double>& low,
              const std::vector<double>& high, const std::string& colour) {
        layers_.push_back({Layer::Kind::Bars, x, low, high, colour, "", false, half});
    }
    /// A vertical bar from low to high at x, with a dot at y.
    void interval(double x, double y, double low, double high, const std::string& colour,
                  const std::string& name = {}) {
        layers_.push_back({Layer::Kind::Interval, {x, x}, {low, y}, {high, y}, colour, name});
    }
    /// Words at (x, y), which begin there or have their middle there.
    void text(double x, double y, const std::string& words, const std::string& colour, bool middle = false) {
        layers_.push_back({Layer::Kind::Text, {x}, {y}, {}, colour, words, middle});
    }
    /// A grey line at y across the chart, and a reason for the y axis to reach there.
    void level(double y, const std::string& name = {}) {
        layers_.push_back({Layer::Kind::Level, {}, {y}, {}, "#888888", name, true});
    }
    /// Texts instead of numbers at x = 0, 1, 2, ...
    void categories(std::vector<std::string> names) { categories_ = std::move(names); }
    /// A line below the title.
    void caption(std::string words) { caption_ = std::move(words); }
    /// The same length on both axes.
    void equal_axes() { equal_ = true; }
    /// The y axis is made from what lies between these quantiles of all points (0..1), so that a few wild
    /// values do not flatten the rest; such points are drawn at the edge.
    void clip(double low, double high) { clip_low_ = low, clip_high_ = high; }

    /// Size in pixels at 96 a inch.
    std::string svg(double width, double height) const;

  private:
    struct Layer {
        enum class Kind { Points, Dots, Line, Band, Bars, Interval, Level, Text } kind;
        std::vector<double> x, y, high;  // y is the low side of a band
        std::string colour, name{};
        bool dashed = false;  // of a text: its middle is at x
        double half = 0.0;    // of bars
    };

    Scale scale_of(bool vertical, int wanted) const;
    std::string legend(double left, double top) const;

    std::string title_, x_label_, y_label_, caption_;
    std::vector<Layer> layers_;
    std::vector<std::string> categories_;
    bool equal_ = false;
    double clip_low_ = 0.0, clip_high_ = 1.0;
};

}  // namespace puckloop
