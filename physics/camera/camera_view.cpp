#include "physics/camera/camera_view.h"

#include "physics/camera/pixel_noise.h"

#include <algorithm>
#include <cmath>

namespace puckloop::physics {

namespace {

constexpr float kFarDepth = 1e9F;
constexpr double kWhiteFloor = 0.85;  // share of the light that comes back from floor_grey = 1
constexpr double kBlackFloor = 0.04;
constexpr std::array<float, 3> kRoom{0.45F, 0.45F,
                                     0.45F};  // what is behind the walls, share of a white floor
/// A side lit from everywhere is darker where it turns away.
constexpr double kSideOn = 0.7, kFacing = 0.3;
constexpr int kDefaultGain = 26;
constexpr double kGainDoubles = 16.0;

}  // namespace

CameraView::CameraView(CameraKind kind, const CameraScene& scene, std::size_t robot,
                       const std::string& robot_name, std::uint64_t seed)
    : kind_(kind),
      scene_(scene),
      robot_(robot),
      parameters_(scene.parameters(robot).camera),
      body_(scene.parameters(robot).robot),
      noise_seed_(
          RandomStream(seed, robot_name + (kind == CameraKind::Omni ? ".camera.omni" : ".camera.front"))
              .next()) {}

CameraView::Mode& CameraView::mode(ImageSize size) {
    std::unique_ptr<Mode>& found = modes_[size.width];
    if (!found || found->optics.size() != size) {
        const Optics optics(kind_, parameters_, size);
        found = std::make_unique<Mode>(Mode{optics, PixelMap(optics)});
    }
    return *found;
}

/// Which columns can meet which bodies, and where.
void CameraView::meet_bodies(const Mode& mode) {
    const auto& directions = mode.map.columns();
    columns_.resize(directions.size());
    for (auto& column : columns_)
        column.clear();
    const auto colour = [](const std::array<double, 3>& shares, double light) {
        return Colour{static_cast<float>(shares[0] * light), static_cast<float>(shares[1] * light),
                      static_cast<float>(shares[2] * light)};
    };
    for (const Body& body : bodies_) {
        const Shape& shape = body.shape;
        // A column meets the circle around the shape if it points closer to its middle than this.
        const double dx = shape.x - x_, dy = shape.y - y_;
        const double distance = std::hypot(dx, dy);
        const double reach =
            shape.kind == Shape::Kind::Box ? std::hypot(shape.half_length, shape.half_width) : shape.radius;
        const double closest = distance > reach ? std::sqrt(1 - reach * reach / (distance * distance)) : -1.0;
        const double ux = distance > 0 ? (cosine_ * dx + sine_ * dy) / distance : 1.0;
        const double uy = distance > 0 ? (-sine_ * dx + cosine_ * dy) / distance : 0.0;
        for (std::size_t i = 0; i < directions.size(); ++i) {
            if (directions[i].x * ux + directions[i].y * uy < closest - 1e-9) continue;
            const double wx = cosine_ * directions[i].x - sine_ * directions[i].y;
            const double wy = sine_ * directions[i].x + cosine_ * directions[i].y;
            const auto met = chord(shape, x_, y_, wx, wy);
            if (!met || met->out <= 0) continue;
            columns_[i].push_back(
                {static_cast<float>(met->in), static_cast<float>(met->out), static_cast<float>(shape.height),
                 colour(body.side, kSideOn + kFacing * met->cosine), colour(body.top, 1.0)});
        }
    }
    for (auto& column : columns_)
        std::sort(column.begin(), column.end(), [](const Span& a, const Span& b) { return a.in < b.in; });
}

CameraView::Colour CameraView::floor_at(double x, double y) const {
    const auto seen = [](double share) {
        return static_cast<float>(kBlackFloor + (kWhiteFloor - kBlackFloor) * share);
    };
    double grey = scene_.floor_grey();
    const auto& patches = scene_.patches();
    for (auto patch = patches.rbegin(); patch != patches.rend(); ++patch) {
        const double dx = x - patch->x, dy = y - patch->y;
        if (dx * dx + dy * dy > patch->reach * patch->reach) continue;
        const bool within =
            patch->disc || (std::abs(patch->cosine * dx + patch->sine * dy) <= patch->half_length &&
                            std::abs(-patch->sine * dx + patch->cosine * dy) <= patch->half_width);
        if (!within) continue;
        if (!patch->image.empty()) {
            const Rgb& colour =
                patch->image.at(0.5 + (patch->cosine * dx + patch->sine * dy) / (2 * patch->half_length),
                                0.5 + (-patch->sine * dx + patch->cosine * dy) / (2 * patch->half_width));
            return {seen(colour[0] / 255.0), seen(colour[1] / 255.0), seen(colour[2] / 255.0)};
        }
        grey = patch->grey;
        break;
    }
    const float share = seen(grey);
    return {share, share, share};
}

/// The distance seen from above at which a ray of that slope ends on something; kFarDepth: on the floor or
/// nowhere.
float CameraView::hidden_from(const std::vector<Span>& column, float slope) const {
    const auto height =
        static_cast<float>(kind_ == CameraKind::Omni ? parameters_.height : parameters_.front_height);
    for (const Span& span : column) {
        const float z = height - slope * span.in;
        if (span.in > 0 && z >= 0 && z <= span.height) return span.in;
        if (z > span.height && height - slope * span.out <= span.height)
            return (height - span.height) / slope;
    }
    return kFarDepth;
}

void CameraView::draw_pixels(const Mode& mode) {
    const auto& pixels = mode.map.pixels();
    const auto& directions = mode.map.columns();
    light_.assign(pixels.size(), Colour{});
    const auto height = static_cast<float>(mode.optics.z());
    const bool mirror = kind_ == CameraKind::Omni;
    const auto own = static_cast<float>((parameters_.height - body_.height) / body_.radius);
    constexpr Colour kOwnBody{0.08F, 0.1F, 0.08F};
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const PixelMap::Pixel& pixel = pixels[i];
        if (pixel.column == PixelMap::kNoColumn) continue;
        if (mirror && pixel.slope > own) {
            light_[i] = kOwnBody;
            continue;
        }
        const Span* met = nullptr;
        bool on_top = false;
        for (const Span& span : columns_[pixel.column]) {
            const float z = height - pixel.slope * span.in;
            if (span.in > 0 && z >= 0 && z <= span.height) {
                met = &span;
                break;
            }
            if (z > span.height && height - pixel.slope * span.out <= span.height) {
                met = &span;
                on_top = true;
                break;
            }
        }
        if (met != nullptr) {
            light_[i] = on_top ? met->top : met->side;
        } else if (pixel.slope > 0) {
            const double distance = mode.optics.z() / pixel.slope;
            const auto& along = directions[pixel.column];
            light_[i] = floor_at(x_ + distance * (cosine_ * along.x - sine_ * along.y),
                                 y_ + distance * (sine_ * along.x + cosine_ * along.y));
        } else {
            light_[i] = kRoom;
        }
    }
    const auto scale = static_cast<float>(parameters_.exposure * scene_.ambient() / kWhiteFloor);
    for (Colour& colour : light_)
        for (float& channel : colour)
            channel *= scale;
}

/// Everything within `radius` of the glow's middle shines; one that is smaller than a pixel shines the less.
void CameraView::draw_glow(const Mode& mode, const Glow& glow) {
    const double dx = glow.x - x_, dy = glow.y - y_;
    const double ahead = cosine_ * dx + sine_ * dy;
    const double left = -sine_ * dx + cosine_ * dy;
    const double up = glow.z - mode.optics.z();
    const auto middle = mode.optics.project(ahead, left, up);
    const double plan = std::hypot(ahead, left);
    if (!middle || plan < glow.radius) return;
    // Pixels a metre, along the image's height and across, as wide as one step around the middle shows.
    const auto moved = [&](double a, double l, double u) {
        const auto point = mode.optics.project(ahead + a, left + l, up + u);
        return point ? std::hypot(point->u - middle->u, point->v - middle->v) : 0.0;
    };
    constexpr double kStep = 1e-4;
    const double across = moved(-left / plan * kStep, ahead / plan * kStep, 0) / kStep;
    const double along = std::max(moved(0, 0, kStep), moved(0, 0, -kStep)) / kStep;
    if (across <= 0 || along <= 0) return;
    const double pixel = 1 / std::sqrt(across * along);  // m
    constexpr double kSmallest = 0.6;                    // pixels: what is smaller falls between two
    const double radius = std::max(glow.radius, kSmallest * pixel);
    const double strength = glow.radius * glow.radius / (radius * radius);
    const double reach = radius + pixel;

    const ImageSize size = mode.optics.size();
    const auto first = [](double value) { return std::max(0L, std::lround(std::floor(value))); };
    const double extent = reach * std::max(across, along) + 1;
    const long last_u = std::min<long>(size.width - 1, std::lround(std::ceil(middle->u + extent)));
    const long last_v = std::min<long>(size.height - 1, std::lround(std::ceil(middle->v + extent)));
    for (long v = first(middle->v - extent); v <= last_v; ++v) {
        for (long u = first(middle->u - extent); u <= last_u; ++u) {
            const auto ray =
                mode.optics.direction({static_cast<double>(u) + 0.5, static_cast<double>(v) + 0.5});
            if (!ray) continue;
            const double length = std::sqrt(1 + ray->slope * ray->slope);
            const double t = (ahead * ray->x + left * ray->y - up * ray->slope) / length;
            if (t <= 0) continue;
            const double square = ahead * ahead + left * left + up * up - t * t;
            const double off = std::sqrt(std::max(0.0, square));
            const double share = std::clamp((radius - off) / pixel + 0.5, 0.0, 1.0) * strength;
            if (share <= 0) continue;
            const auto index = static_cast<std::size_t>(v) * size.width + static_cast<std::size_t>(u);
            const PixelMap::Pixel& own = mode.map.pixels()[index];
            if (own.column == PixelMap::kNoColumn) continue;
            if (hidden_from(columns_[own.column], own.slope) < plan - glow.radius) continue;
            Colour& colour = light_[index];
            const double sum = glow.level[0] + glow.level[1] + glow.level[2];
            for (std::size_t c = 0; c < colour.size(); ++c) {
                const double level = glow.level[c] + parameters_.crosstalk * (sum - glow.level[c]);
                colour[c] = static_cast<float>((1 - share) * colour[c] + share * level);
            }
        }
    }
}

void CameraView::render(ImageSize size, const Exposure& exposure, std::uint64_t frame,
                        std::span<std::uint8_t> rgb) {
    const Mode& how = mode(size);
    const CameraScene::Pose& pose = scene_.robot(robot_);
    cosine_ = std::cos(pose.heading);
    sine_ = std::sin(pose.heading);
    x_ = pose.x + cosine_ * how.optics.x();
    y_ = pose.y + sine_ * how.optics.x();
    scene_.bodies(robot_, bodies_);
    scene_.glows(robot_, glows_);
    meet_bodies(how);
    draw_pixels(how);
    for (const Glow& glow : glows_)
        draw_glow(how, glow);
    expose(size, exposure, frame, rgb);
}

void CameraView::expose(ImageSize size, const Exposure& exposure, std::uint64_t frame,
                        std::span<std::uint8_t> rgb) const {
    const double gain = std::exp2((exposure.gain - kDefaultGain) / kGainDoubles);
    // Gain amplifies the noise with the light.
    const NoiseTable& noise = noise_table();
    const auto spread = static_cast<float>(255 * parameters_.noise * gain);
    const auto scale = static_cast<float>(255 * gain);
    const auto contrast = static_cast<float>(exposure.contrast / 100.0);
    const auto saturation = static_cast<float>(exposure.saturation / 100.0);
    const auto offset =
        static_cast<float>(exposure.brightness * 2.55 + 127.5 * (1 - exposure.contrast / 100.0));
    PixelNoise draws(noise_seed_, frame);
    for (std::uint32_t row = 0; row < size.height; ++row) {
        const std::uint32_t to_row = exposure.flip ? size.height - 1 - row : row;
        for (std::uint32_t u = 0; u < size.width; ++u) {
            const Colour& light = light_[std::size_t{row} * size.width + u];
            const std::uint64_t bits = draws.next();
            Colour value;
            for (std::size_t c = 0; c < value.size(); ++c) {
                const float drawn = noise[(bits >> (16 * c)) & (noise.size() - 1)];
                value[c] = std::clamp(scale * light[c] + spread * drawn, 0.0F, 255.0F);
            }
            const float mean = (value[0] + value[1] + value[2]) / 3;
            const std::uint32_t to_u = exposure.mirror ? size.width - 1 - u : u;
            std::uint8_t* out = rgb.data() + (std::size_t{to_row} * size.width + to_u) * 3;
            for (std::size_t c = 0; c < value.size(); ++c) {
                const float coloured = mean + saturation * (value[c] - mean);
                out[c] = static_cast<std::uint8_t>(std::clamp(contrast * coloured + offset, 0.0F, 255.0F) +
                                                   0.499F);
            }
        }
    }
}

}  // namespace puckloop::physics
