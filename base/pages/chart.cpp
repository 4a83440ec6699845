#include "base/pages/chart.h"

#include "base/pages/svg.h"
#include "base/quantile.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace puckloop {

namespace {

constexpr double kLeft = 58, kRight = 20, kTop = 40, kBottom = 42;  // pixels round the plot
constexpr std::size_t kMostPoints = 1500;
constexpr double kLetter = 5.8;              // pixels wide, about
constexpr double kLine = 16;                 // pixels of a caption
constexpr double kSmall = 300, kWide = 600;  // pixels wide: fewer or more ticks
constexpr const char* kGrid = "#dddddd";
constexpr const char* kThick = "stroke-width=\"2\"";

std::string text_at(double x, double y, const std::string& text, const char* anchor, const char* more = "") {
    return svg_text(x, y, text, fmt::format("text-anchor=\"{}\" {}", anchor, more));
}

std::string segment(double x1, double y1, double x2, double y2, const std::string& colour,
                    const char* style) {
    return svg_line(x1, y1, x2, y2, fmt::format("stroke=\"{}\" {}", colour, style));
}

std::string dot(double x, double y, const std::string& colour, const char* radius, const char* more = "") {
    return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" fill=\"{}\"{}/>\n", x, y, radius, colour,
                       more);
}

/// From the first to the last whole step inside.
Scale whole_steps(const Scale& s) {
    return {std::ceil(s.low / s.step - 1e-9) * s.step, std::floor(s.high / s.step + 1e-9) * s.step, s.step};
}

}  // namespace

Scale Scale::covering(double low, double high, int wanted) {
    if (!std::isfinite(low) || !std::isfinite(high)) low = 0, high = 1;
    if (high - low <= 1e-12 * std::max(std::fabs(low), std::fabs(high))) {
        const double room = low == 0 ? 1.0 : 0.1 * std::fabs(low);
        low -= room, high += room;
    }
    const double rough = (high - low) / wanted;
    const double decade = std::pow(10, std::floor(std::log10(rough)));
    const double share = rough / decade;
    const double step = decade * (share < 1.5 ? 1 : share < 3.5 ? 2 : share < 7.5 ? 5 : 10);
    return {std::floor(low / step + 1e-9) * step, std::ceil(high / step - 1e-9) * step, step};
}

std::vector<double> Scale::ticks() const {
    std::vector<double> result;
    const auto count = std::lround((high - low) / step);
    for (long i = 0; i <= count; ++i)
        result.push_back(low + static_cast<double>(i) * step);
    return result;
}

std::string Scale::label(double tick) const {
    if (std::fabs(tick) < 1e-9 * step) return "0";
    const double size = std::max(std::fabs(low), std::fabs(high));
    if (size >= 1e6 || size < 1e-3) return fmt::format("{:.3g}", tick);
    const int decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
    return fmt::format("{:.{}f}", tick, decimals);
}

Chart::Chart(std::string title, std::string x_label, std::string y_label)
    : title_(std::move(title)), x_label_(std::move(x_label)), y_label_(std::move(y_label)) {}

void Chart::points(const std::vector<double>& x, const std::vector<double>& y, const std::string& colour,
                   const std::string& name) {
    std::vector<std::size_t> whole;
    for (std::size_t i = 0; i < x.size(); ++i)
        if (std::isfinite(x[i]) && std::isfinite(y[i])) whole.push_back(i);
    Layer layer{Layer::Kind::Points, {}, {}, {}, colour, name};
    const std::size_t stride = std::max<std::size_t>((whole.size() + kMostPoints - 1) / kMostPoints, 1);
    for (std::size_t k = 0; k < whole.size(); k += stride) {
        layer.x.push_back(x[whole[k]]);
        layer.y.push_back(y[whole[k]]);
    }
    layers_.push_back(std::move(layer));
}

Scale Chart::scale_of(bool vertical, int wanted) const {
    std::vector<double> values, dots;
    for (const Layer& layer : layers_) {
        auto& into = vertical && layer.kind == Layer::Kind::Points ? dots : values;
        const auto& from = vertical ? layer.y : layer.x;
        into.insert(into.end(), from.begin(), from.end());
        for (std::size_t i = 0; !vertical && layer.half > 0 && i < from.size(); ++i)
            into.insert(into.end(), {from[i] - layer.half, from[i] + layer.half});
        if (vertical) values.insert(values.end(), layer.high.begin(), layer.high.end());
    }
    if (!dots.empty()) {
        const double low = quantile(dots, clip_low_), high = quantile(dots, clip_high_);
        const double room = clip_high_ < 1 ? 0.15 * (high - low) : 0.0;
        values.push_back(std::max(low - room, quantile(dots, 0)));
        values.push_back(std::min(high + room, quantile(dots, 1)));
    }
    if (!vertical && !categories_.empty()) return {-0.5, static_cast<double>(categories_.size()) - 0.5, 1};
    return Scale::covering(quantile(values, 0), quantile(values, 1), wanted);
}

std::string Chart::legend(double left, double top) const {
    std::string out;
    double x = left;
    for (const Layer& layer : layers_) {
        if (layer.name.empty() || layer.kind == Layer::Kind::Text) continue;
        if (layer.kind == Layer::Kind::Points || layer.kind == Layer::Kind::Dots)
            out += dot(x + 6, top - 4, layer.colour, "3");
        else
            out += segment(x, top - 4, x + 12, top - 4, layer.colour,
                           layer.dashed ? "stroke-width=\"2\" stroke-dasharray=\"4 3\"" : kThick);
        out += text_at(x + 16, top, layer.name, "start");
        x += 26 + 5.6 * static_cast<double>(layer.name.size());
    }
    return out;
}

std::string Chart::svg(double width, double height) const {
    // Labels stay apart in small charts, too.
    Scale xs = scale_of(false, width < kSmall  ? 3
                               : width < kWide ? 4
                                               : 9),
          ys = scale_of(true, width < kSmall ? 4 : 5);
    const double top = kTop + (caption_.empty() ? 0 : kLine), bottom = height - kBottom,
                 right = width - kRight;
    // Equal axes: the shorter one is widened about its middle, to whole steps; then both to the same unit.
    for (const bool to_steps : equal_ ? std::vector{true, false} : std::vector<bool>{}) {
        const double unit =
            std::max((xs.high - xs.low) / (right - kLeft), (ys.high - ys.low) / (bottom - top));
        for (auto [scale, pixels] : {std::pair{&xs, right - kLeft}, {&ys, bottom - top}}) {
            const double middle = (scale->low + scale->high) / 2, half = unit * pixels / 2;
            const Scale wide{middle - half, middle + half, scale->step};
            *scale = to_steps ? whole_steps(wide) : wide;
        }
    }
    const auto px = [&](double x) { return kLeft + (x - xs.low) / (xs.high - xs.low) * (right - kLeft); };
    const auto py = [&](double y) {
        return bottom - (std::clamp(y, ys.low, ys.high) - ys.low) / (ys.high - ys.low) * (bottom - top);
    };
    const auto places = [&](const std::vector<double>& x, const std::vector<double>& y) {
        std::vector<std::string> all;
        for (std::size_t i = 0; i < x.size(); ++i)
            if (std::isfinite(x[i]) && std::isfinite(y[i]))
                all.push_back(fmt::format("{:.1f},{:.1f}", px(x[i]), py(y[i])));
        return all;
    };
    std::string out;
    std::string grid;
    for (const double tick : whole_steps(ys).ticks()) {
        grid += fmt::format("M{:.1f} {:.1f}H{:.1f}", kLeft, py(tick), right);
        out += text_at(kLeft - 5, py(tick) + 3.5, ys.label(tick), "end");
    }
    if (categories_.empty())
        for (const double tick : whole_steps(xs).ticks()) {
            grid += fmt::format("M{:.1f} {:.1f}V{:.1f}", px(tick), top, bottom);
            // Long labels stand at every second tick.
            const bool crowded =
                kLetter * static_cast<double>(xs.label(tick).size() + 1) > px(tick + xs.step) - px(tick);
            if (crowded && std::lround(tick / xs.step) % 2 != 0) continue;
            out += text_at(px(tick), bottom + 14, xs.label(tick), "middle");
        }
    for (std::size_t i = 0; i < categories_.size(); ++i)
        out += text_at(px(static_cast<double>(i)), bottom + 14, categories_[i], "middle");
    out += fmt::format("<path d=\"{}\" stroke=\"{}\"/>\n", grid, kGrid);
    using enum Layer::Kind;
    for (const Layer& layer : layers_) {
        // Of all points, places as `shape` writes them.
        const auto path = [&](const auto& shape) {
            std::string all;
            for (std::size_t i = 0; i < layer.x.size(); ++i)
                if (std::isfinite(layer.y[i])) all += shape(px(layer.x[i]), py(layer.y[i]), i);
            return all;
        };
        if (layer.kind == Level)
            out += segment(kLeft, py(layer.y[0]), right, py(layer.y[0]), layer.colour,
                           "stroke-dasharray=\"4 3\"");
        if (layer.kind == Points)
            out += path([&](double x, double y, std::size_t) {
                return dot(x, y, layer.colour, "1.6", " fill-opacity=\"0.55\"");
            });
        if (layer.kind == Dots)
            out += fmt::format(
                "<path d=\"{}\" stroke=\"{}\" stroke-width=\"4.4\" stroke-linecap=\"round\"/>\n",
                path([](double x, double y, std::size_t) { return fmt::format("M{:.1f} {:.1f}h0", x, y); }),
                layer.colour);
        if (layer.kind == Bars)
            out += fmt::format("<path d=\"{}\" fill=\"{}\" fill-opacity=\"0.3\"/>\n",
                               path([&](double, double y, std::size_t i) {
                                   const double from = px(layer.x[i] - layer.half);
                                   return fmt::format("M{:.1f} {:.1f}H{:.1f}V{:.1f}H{:.1f}z", from, y,
                                                      px(layer.x[i] + layer.half), py(layer.high[i]), from);
                               }),
                               layer.colour);
        if (layer.kind == Interval) {
            const double x = px(layer.x[0]);
            out += segment(x, py(layer.y[0]), x, py(layer.high[0]), layer.colour, kThick);
            out += dot(x, py(layer.y[1]), layer.colour, "3.5");
        }
        if (layer.kind == Text)
            out += text_at(px(layer.x[0]), py(layer.y[0]), layer.name, layer.dashed ? "middle" : "start",
                           fmt::format("fill=\"{}\"", layer.colour).c_str());
        if (layer.kind == Line)
            out +=
                fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.6\"{}/>\n",
                            fmt::join(places(layer.x, layer.y), " "), layer.colour,
                            layer.dashed ? " stroke-dasharray=\"5 3\"" : "");
        if (layer.kind == Band) {
            auto outline = places(layer.x, layer.y), back = places(layer.x, layer.high);
            outline.insert(outline.end(), back.rbegin(), back.rend());
            out += fmt::format("<polygon points=\"{}\" fill=\"{}\" fill-opacity=\"0.22\"/>\n",
                               fmt::join(outline, " "), layer.colour);
        }
    }
    out += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"none\" "
                       "stroke=\"#999999\"/>\n",
                       kLeft, top, right - kLeft, bottom - top);
    out += text_at(kLeft, 14, title_, "start", "font-size=\"11\" font-weight=\"bold\"");
    if (!caption_.empty()) out += text_at(kLeft, 14 + kLine, caption_, "start");
    out += legend(kLeft, top - 8);
    out += text_at((kLeft + right) / 2, height - 8, x_label_, "middle");
    out += text_at(0, 0, y_label_, "middle",
                   fmt::format("transform=\"translate(12,{:.1f}) rotate(-90)\"", (top + bottom) / 2).c_str());
    return svg_document(width, height, 10, out);
}

}  // namespace puckloop
