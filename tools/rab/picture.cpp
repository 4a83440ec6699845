#include "tools/rab/picture.h"

#include "protocols/rab_reading.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::tools {

namespace {

// Layout in pixels.
constexpr double kWidth = 900, kLeft = 76, kRight = 20, kTop = 92, kPanel = 200, kGap = 44, kBottom = 74;
constexpr double kCentimetres = 100;
constexpr double kZ90 = 1.2815516;  // standard normal quantile of 90 %
constexpr const char* kMeasured = "#1f6fb2";
constexpr const char* kPublished = "#c2541b";
constexpr const char* kFaint = "#8a8a8a";

/// One panel: its place on the page and the scale of its y axis.
struct Panel {
    double top, low, high;
    double y(double value) const {
        return top + kPanel * (high - std::clamp(value, low, high)) / (high - low);
    }
};

class Page {
  public:
    Page(const std::vector<RabSummary>& summary, const std::string& caption)
        : summary_(summary),
          column_((kWidth - kLeft - kRight) / static_cast<double>(std::max<std::size_t>(summary.size(), 1))) {
        const double height = kTop + 3 * kPanel + 2 * kGap + kBottom;
        svg_ = fmt::format(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:g} {1:g}\" width=\"{0:g}\" "
            "height=\"{1:g}\" font-family=\"sans-serif\" font-size=\"12\">\n"
            "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
            kWidth, height);
        text(kLeft, 28, "Range and bearing of emulated boards", "font-size=\"18\" font-weight=\"bold\"");
        text(kLeft, 48, caption, "fill=\"#555\"");
        legend();
    }

    void strength() {
        double high = 1000;
        for (const RabSummary& s : summary_) {
            high = std::max(high, s.strength.p95);  // a few readings lie beyond the panel
            if (const auto p = published_at(s.distance))
                high = std::max(high, std::exp(p->mu + kZ90 * p->sigma));
        }
        const Panel panel{kTop, 0, std::ceil(high / 500) * 500};
        frame(panel, "strength (range register)", 500);
        for (std::size_t i = 0; i < summary_.size(); ++i) {
            const RabSummary& s = summary_[i];
            readings(panel, i, s.strengths);
            whisker(panel, i, kRightSide, s.strength.p10, s.strength.median, s.strength.p90, kMeasured);
            if (const auto p = published_at(s.distance))
                whisker(panel, i, kLeftSide, std::exp(p->mu - kZ90 * p->sigma), std::exp(p->mu),
                        std::exp(p->mu + kZ90 * p->sigma), kPublished);
        }
    }

    /// The published formula on both; the dash is the truth.
    void distance() {
        const auto estimate = [](const PublishedStrength& p, double z) {
            return protocols::rab_distance_cm(std::exp(p.mu + z * p.sigma));
        };
        double high = 50;
        for (const RabSummary& s : summary_) {
            high = std::max({high, s.distance * kCentimetres, s.estimate_cm.p90});
            if (const auto p = published_at(s.distance)) high = std::max(high, estimate(*p, -kZ90));
        }
        const Panel panel{kTop + kPanel + kGap, 0, std::ceil(high / 20) * 20};
        frame(panel, "distance worked out, cm", 20);
        for (std::size_t i = 0; i < summary_.size(); ++i) {
            const RabSummary& s = summary_[i];
            const double truth = panel.y(s.distance * kCentimetres);
            svg_ += fmt::format("<line x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\" "
                                "stroke=\"#333\" stroke-dasharray=\"4 3\"/>\n",
                                x(i, -0.42), x(i, 0.42), truth, truth);
            whisker(panel, i, kRightSide, s.estimate_cm.p10, s.estimate_cm.median, s.estimate_cm.p90,
                    kMeasured);
            if (const auto p = published_at(s.distance))
                whisker(panel, i, kLeftSide, estimate(*p, kZ90), estimate(*p, 0), estimate(*p, -kZ90),
                        kPublished);
        }
    }

    void bearing() {
        double high = 10;
        for (const RabSummary& s : summary_)
            high = std::max({high, s.bearing_error.p95, -s.bearing_error.p5});
        high = std::ceil(high / 10) * 10;
        const Panel panel{kTop + 2 * (kPanel + kGap), -high, high};
        frame(panel, "bearing error, deg", high > 30 ? 20 : 10);
        for (std::size_t i = 0; i < summary_.size(); ++i) {
            const Spread& b = summary_[i].bearing_error;
            readings(panel, i, summary_[i].bearing_errors);
            if (summary_[i].received == 0) continue;
            svg_ += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" "
                                "fill=\"#fff\" fill-opacity=\".7\" stroke=\"{}\"/>\n",
                                x(i, kRightSide) - 7, panel.y(b.p75), 14.0,
                                std::max(panel.y(b.p25) - panel.y(b.p75), 1.0), kMeasured);
            whisker(panel, i, kRightSide, b.p5, b.median, b.p95, kMeasured);
        }
        foot(panel);
    }

    std::string done() { return svg_ + "</svg>\n"; }

  private:
    static constexpr double kLeftSide = -0.2, kRightSide = 0.14;

    double x(std::size_t column, double share) const {
        return kLeft + column_ * (static_cast<double>(column) + 0.5 + share);
    }
    void text(double at_x, double at_y, const std::string& what, const std::string& style = {}) {
        svg_ += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" {}>{}</text>\n", at_x, at_y, style, what);
    }
    void legend() {
        const auto entry = [this](double at, const char* colour, const std::string& what) {
            svg_ += fmt::format("<circle cx=\"{}\" cy=\"68\" r=\"4\" fill=\"{}\"/>\n", at, colour);
            text(at + 9, 72, what);
        };
        entry(kLeft + 5, kPublished, "published log-normal of real boards: median, 10 to 90 %");
        entry(kLeft + 400, kMeasured, "emulated: median, 10 to 90 % (bearing: quartiles, 5 to 95 %)");
    }
    void frame(const Panel& panel, const std::string& title, double step) {
        for (double value = panel.low; value <= panel.high + step / 2; value += step) {
            svg_ += fmt::format(
                "<line x1=\"{:g}\" x2=\"{:g}\" y1=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#e2e2e2\"/>\n", kLeft,
                kWidth - kRight, panel.y(value), panel.y(value));
            text(kLeft - 8, panel.y(value) + 4, fmt::format("{:g}", value),
                 "text-anchor=\"end\" fill=\"#555\"");
        }
        const double middle = panel.top + kPanel / 2;
        text(20, middle, title,
             fmt::format("text-anchor=\"middle\" transform=\"rotate(-90 20 {:.1f})\"", middle));
    }
    void whisker(const Panel& panel, std::size_t column, double side, double low, double median, double high,
                 const char* colour) {
        if (median == 0.0 && low == 0.0 && high == 0.0) return;
        const double at = x(column, side);
        svg_ +=
            fmt::format("<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{2:.1f}\" stroke=\"{3}\" "
                        "stroke-width=\"2\"/><circle cx=\"{0:.1f}\" cy=\"{4:.1f}\" r=\"4\" fill=\"{3}\"/>\n",
                        at, panel.y(low), panel.y(high), colour, panel.y(median));
    }
    /// Every reading as a faint dot, spread over the column's right third; at most some hundreds.
    void readings(const Panel& panel, std::size_t column, const std::vector<double>& values) {
        constexpr std::size_t kMost = 160;
        const std::size_t stride = values.size() / kMost + 1;
        svg_ += fmt::format("<g fill=\"{}\" fill-opacity=\".35\">", kMeasured);
        for (std::size_t i = 0; i < values.size(); i += stride) {
            if (values[i] < panel.low || values[i] > panel.high) continue;
            const double share = 0.26 + 0.2 * static_cast<double>(i % 17) / 17;
            svg_ += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"1.3\"/>", x(column, share),
                                panel.y(values[i]));
        }
        svg_ += "</g>\n";
    }
    void foot(const Panel& panel) {
        const double base = panel.top + kPanel;
        for (std::size_t i = 0; i < summary_.size(); ++i) {
            const RabSummary& s = summary_[i];
            text(x(i, 0), base + 20, fmt::format("{:g} cm", s.distance * kCentimetres),
                 "text-anchor=\"middle\" font-weight=\"bold\"");
            const double share =
                s.sent > 0 ? 100.0 * static_cast<double>(s.received) / static_cast<double>(s.sent) : 0;
            text(x(i, 0), base + 37, fmt::format("{:.0f} % read", share),
                 fmt::format("text-anchor=\"middle\" fill=\"{}\"", kFaint));
        }
        text(kLeft, base + 60, "Columns: free distance between the robots. Dashes: the true distance.",
             "fill=\"#555\"");
    }

    const std::vector<RabSummary>& summary_;
    double column_;
    std::string svg_;
};

}  // namespace

std::string rab_picture(const std::vector<RabSummary>& summary, const std::string& caption) {
    Page page(summary, caption);
    page.strength();
    page.distance();
    page.bearing();
    return page.done();
}

}  // namespace puckloop::tools
