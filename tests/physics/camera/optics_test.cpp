// The geometry of the cameras against the law of reflection, and pictures against rays followed in small
// steps through space.

#include "physics/camera/camera_view.h"
#include "physics/camera/optics.h"
#include "tests/physics/worlds.h"

#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <random>

using namespace puckloop;
using namespace puckloop::physics;
using namespace puckloop::physics::test;

namespace {

using Random = std::mt19937_64;

double between(Random& random, double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
}

CameraParameters defaults() {
    return Parameters().camera;
}

/// The slope (down per metre out) of the scene's ray that a camera in the outer focus of a hyperboloid sees
/// at `elevation`: by meeting the mirror's surface and reflecting there. Half the distance of the foci is 1.
double reflected_slope(double eccentricity, double elevation) {
    const double a = 1 / eccentricity, a2 = a * a, b2 = 1 - a2;
    // From the camera at height -1 along (cos, sin): z^2 / a2 - r^2 / b2 = 1 on the sheet around +1.
    const double dr = std::cos(elevation), dz = std::sin(elevation);
    const double qa = dz * dz / a2 - dr * dr / b2;
    const double qb = -2 * dz / a2;
    const double qc = 1 / a2 - 1;
    double best = -1;
    for (const double sign : {-1.0, 1.0}) {
        const double t = (-qb + sign * std::sqrt(qb * qb - 4 * qa * qc)) / (2 * qa);
        if (t > 0 && -1 + t * dz > 0) best = t;
    }
    if (best <= 0 || best > 1e3) return -1e9;  // past the mirror, which ends long before
    const double r = best * dr, z = -1 + best * dz;
    const double gr = -2 * r / b2, gz = 2 * z / a2;  // normal
    const double square = gr * gr + gz * gz, along = dr * gr + dz * gz;
    const double out_r = dr - 2 * along * gr / square, out_z = dz - 2 * along * gz / square;
    // All such rays come from the inner focus, on the axis at height 1.
    CHECK(r * out_z - (z - 1) * out_r == Approx(0).margin(1e-9));
    REQUIRE(out_r > 0);
    return -out_z / out_r;
}

}  // namespace

TEST_CASE("the omnidirectional camera obeys the law of reflection at its mirror") {
    Random random(2016);
    for (int i = 0; i < 300; ++i) {
        CameraParameters p = defaults();
        p.eccentricity = between(random, 1.3, 6.0);
        // No ray looks up more steeply than the mirror's asymptote.
        p.rim_elevation = between(random, -0.2, 0.9 * std::asin(1 / p.eccentricity));
        p.centre_x = between(random, -0.1, 0.1);
        p.centre_y = between(random, -0.1, 0.1);
        const ImageSize size = i % 2 == 0 ? ImageSize{352, 288} : ImageSize{640, 480};
        const Optics optics(CameraKind::Omni, p, size);
        const double rim = p.rim * size.height;
        const double u0 = size.width / 2.0 + p.centre_x * size.height;
        const double v0 = size.height / 2.0 + p.centre_y * size.height;
        const double angle = between(random, -3.1, 3.1);
        const double radius = between(random, 0.02, 0.999) * rim;
        const auto ray = optics.direction({u0 + radius * std::cos(angle), v0 + radius * std::sin(angle)});
        REQUIRE(ray);
        // The rim fixes the camera's focal length: find the elevation there by bisection of the reflection.
        double low = 0.01, high = 1.55;
        for (int k = 0; k < 60; ++k) {
            const double middle = (low + high) / 2;
            (reflected_slope(p.eccentricity, middle) < -std::tan(p.rim_elevation) ? low : high) = middle;
        }
        const double focal = rim * std::tan((low + high) / 2);
        CHECK(ray->slope ==
              Approx(reflected_slope(p.eccentricity, std::atan2(focal, radius))).epsilon(1e-6).margin(1e-9));
        // Ahead is to the left of the image, left is up.
        CHECK(ray->x == Approx(-std::cos(angle)).margin(1e-12));
        CHECK(ray->y == Approx(-std::sin(angle)).margin(1e-12));
    }
}

TEST_CASE("points are seen by the pixels whose rays go through them") {
    Random random(7);
    int seen = 0;
    for (int i = 0; i < 2000; ++i) {
        const CameraKind kind = i % 2 == 0 ? CameraKind::Omni : CameraKind::Front;
        const Optics optics(kind, defaults(), {640, 480});
        const double ahead = between(random, -1, 1), left = between(random, -1, 1);
        const double up = between(random, -optics.z(), 0.02);
        const auto point = optics.project(ahead, left, up);
        if (!point) continue;
        const auto ray = optics.direction(*point);
        if (!ray) continue;
        ++seen;
        const double distance = std::hypot(ahead, left);
        CHECK(ray->x == Approx(ahead / distance).margin(1e-7));
        CHECK(ray->y == Approx(left / distance).margin(1e-7));
        CHECK(ray->slope == Approx(-up / distance).margin(1e-6));
    }
    CHECK(seen > 1000);
    // The front camera sees as far to the side as its field of view states, and no mirror sees above its rim.
    const Optics front(CameraKind::Front, defaults(), {640, 480});
    CHECK(front.project(1.0, std::tan(defaults().front_fov / 2), 0.0)->u == Approx(0).margin(1e-9));
    const Optics omni(CameraKind::Omni, defaults(), {640, 480});
    CHECK_FALSE(omni.project(1.0, 0.0, std::tan(defaults().rim_elevation + 0.01)));
    CHECK(omni.project(1.0, 0.0, std::tan(defaults().rim_elevation - 0.01)));
}

TEST_CASE("the default mirror follows the distance curve of ARGoS for a light as high as a TAM's") {
    const CameraParameters p = defaults();
    const Optics omni(CameraKind::Omni, p, {352, 288});
    for (const double centimetres : {10.0, 15.0, 20.0, 30.0, 40.0, 50.0}) {
        const auto point = omni.project(centimetres / 100, 0.0, 0.060 - p.height);
        REQUIRE(point);
        const double pixels = std::hypot(point->u - 182, point->v - 144);
        CHECK(1.25455 * std::pow(1.03848, pixels) == Approx(centimetres).epsilon(0.10));
    }
}

TEST_CASE("LEDs of the turret and of the ring are reported so much too far or near by that curve") {
    const CameraParameters p = defaults();
    const Optics omni(CameraKind::Omni, p, {352, 288});
    const auto reported = [&](double height, double centimetres) {
        const auto point = omni.project(centimetres / 100, 0.0, height - p.height);
        REQUIRE(point);
        return 1.25455 * std::pow(1.03848, std::hypot(point->u - 182, point->v - 144)) / centimetres;
    };
    constexpr double kTam = 0.056, kTurret = 0.0755, kRing = 0.040;
    const std::array<double, 5> turret{1.32, 1.45, 1.40, 1.29, 1.19}, ring{0.65, 0.77, 0.82, 0.82, 0.80};
    for (std::size_t i = 0; i < turret.size(); ++i) {
        const double centimetres = 10.0 * static_cast<double>(i + 1);
        INFO(centimetres << " cm");
        CHECK(reported(kTurret, centimetres) == Approx(turret[i]).margin(0.006));
        CHECK(reported(kRing, centimetres) == Approx(ring[i]).margin(0.006));
        CHECK(reported(kTam, centimetres) == Approx(1.0).margin(0.16));
    }
}

TEST_CASE("a LED of the turret is seen as large as the published blobs at 10 cm") {
    World world = world_with_robot(2.0, 2.0);
    world.parameters["camera.noise"] = 0.0;
    world.ambient_light = 0.0;
    world.robots.push_back(robot_at("e2", 0.1, 0.0, 0.0));
    const CameraSignals ids(world);
    const auto area_at = [&](double distance) {
        CameraScene scene(world);
        scene.change(ids.pose(1), distance);
        scene.change(ids.turret(1, 0), 1.0);  // red of the first
        std::vector<Glow> glows;
        scene.glows(0, glows);
        for (const Glow& glow : glows)  // that one stands where it is asked for
            if (glow.level[0] > 0) scene.change(ids.pose(1), 2 * distance - std::hypot(glow.x, glow.y));
        const ImageSize size{352, 288};
        CameraView view(CameraKind::Omni, scene, 0, "e1", 1);
        std::vector<std::uint8_t> rgb(size.width * size.height * 3);
        view.render(size, {}, 0, rgb);
        int area = 0;
        for (std::size_t i = 0; i < rgb.size(); i += 3)
            area += rgb[i] > 128;
        return area;
    };
    const auto published = [](double distance) { return 95.644 * std::exp(-11.0 * distance); };
    CHECK(area_at(0.10) == Approx(published(0.10)).epsilon(0.15));
    CHECK(area_at(0.15) == Approx(published(0.15)).epsilon(0.40));
    CHECK(area_at(0.20) == Approx(published(0.20)).epsilon(0.70));
}

namespace {

/// What a ray ends on, by going along it in small steps.
struct Hit {
    enum class Kind { Floor, Body, Nothing } kind = Kind::Nothing;
    std::size_t body = 0;
    bool on_top = false;
    double x = 0, y = 0;
};

bool holds(const Shape& s, double x, double y, double z) {
    if (z > s.height || z < 0) return false;
    const double dx = x - s.x, dy = y - s.y;
    if (s.kind == Shape::Kind::Circle) return dx * dx + dy * dy <= s.radius * s.radius;
    return std::abs(s.cosine * dx + s.sine * dy) <= s.half_length &&
           std::abs(-s.sine * dx + s.cosine * dy) <= s.half_width;
}

Hit follow(const std::vector<Shape>& shapes, double x, double y, double z, double dx, double dy, double dz) {
    constexpr double kStep = 2e-4;
    for (double t = 0; t < 4.0; t += kStep) {
        const double px = x + t * dx, py = y + t * dy, pz = z + t * dz;
        if (pz < 0) return {Hit::Kind::Floor, 0, false, px, py};
        for (std::size_t i = 0; i < shapes.size(); ++i)
            if (holds(shapes[i], px, py, pz)) {
                const bool above = !holds(shapes[i], px - kStep * dx, py - kStep * dy, 0.0) ? false : true;
                return {Hit::Kind::Body, i, above, px, py};
            }
    }
    // The floor goes on beyond the walls.
    return dz < 0 ? Hit{Hit::Kind::Floor, 0, false, 99.0, 99.0} : Hit{};
}

}  // namespace

TEST_CASE("pictures show what rays meet, pixel by pixel") {
    Random random(160);
    int compared = 0, wrong = 0;
    for (int round = 0; round < 6; ++round) {
        World world = world_with_robot(1.6, 1.4);
        world.arena.wall_height = 0.08;
        world.arena.reflectivity = 0.5;
        world.robots[0].x = between(random, -0.3, 0.3);
        world.robots[0].y = between(random, -0.3, 0.3);
        world.robots[0].heading = between(random, -3, 3);
        world.parameters["camera.noise"] = 0.0;
        for (int i = 0; i < 3; ++i) {
            const double reflectivity = 0.15 + 0.1 * i;
            world.boxes.push_back({.name = {},
                                   .x = between(random, -0.6, 0.6),
                                   .y = between(random, 0.45, 0.6),
                                   .heading = between(random, 0, 3),
                                   .length = 0.1,
                                   .width = 0.06,
                                   .height = between(random, 0.03, 0.16),
                                   .reflectivity = reflectivity});
            world.cylinders.push_back({.name = {},
                                       .x = between(random, -0.6, 0.6),
                                       .y = between(random, -0.6, -0.45),
                                       .radius = 0.04,
                                       .height = between(random, 0.03, 0.16),
                                       .reflectivity = reflectivity});
        }
        world.patches.push_back(
            {.name = {}, .shape = Patch::Shape::Disc, .x = 0.2, .y = 0.2, .radius = 0.2, .grey = 0.3});
        world.patches.push_back(
            {.name = {}, .x = -0.1, .y = 0.1, .heading = 0.4, .length = 0.3, .width = 0.2, .grey = 0.6});
        const CameraScene scene(world);
        const CameraParameters& p = scene.parameters(0).camera;
        for (const CameraKind kind : {CameraKind::Omni, CameraKind::Front}) {
            const ImageSize size{320, 240};
            CameraView view(kind, scene, 0, "e1", 1);
            std::vector<std::uint8_t> rgb(size.width * size.height * 3);
            view.render(size, {}, 0, rgb);
            const Optics optics(kind, p, size);
            const std::vector<Shape> shapes = fixed_shapes(world);
            const double c = std::cos(world.robots[0].heading), s = std::sin(world.robots[0].heading);
            for (int i = 0; i < 400; ++i) {
                const auto u = std::uniform_int_distribution<std::uint32_t>(0, size.width - 1)(random);
                const auto v = std::uniform_int_distribution<std::uint32_t>(0, size.height - 1)(random);
                const int shown = rgb[(v * size.width + u) * 3];
                const auto ray = optics.direction({u + 0.5, v + 0.5});
                if (!ray) {
                    CHECK(shown == 0);
                    continue;
                }
                const BodyParameters& body = scene.parameters(0).robot;
                if (kind == CameraKind::Omni && ray->slope > 0.99 * (p.height - body.height) / body.radius)
                    continue;
                const double x = world.robots[0].x + c * optics.x(), y = world.robots[0].y + s * optics.x();
                const Hit hit = follow(shapes, x, y, optics.z(), c * ray->x - s * ray->y,
                                       s * ray->x + c * ray->y, -ray->slope);
                const double full = 255 * p.exposure / 0.85;
                double low = 0, high = 0;
                if (hit.kind == Hit::Kind::Floor) {
                    double grey = 1.0;
                    if (std::hypot(hit.x - 0.2, hit.y - 0.2) <= 0.2) grey = 0.3;
                    const double dx = hit.x + 0.1, dy = hit.y - 0.1;
                    if (std::abs(std::cos(0.4) * dx + std::sin(0.4) * dy) <= 0.15 &&
                        std::abs(std::cos(0.4) * dy - std::sin(0.4) * dx) <= 0.1)
                        grey = 0.6;
                    low = high = full * (0.04 + 0.81 * grey);
                } else if (hit.kind == Hit::Kind::Body) {
                    high = full * 0.85 * std::min(1.0, shapes[hit.body].reflectivity);
                    low = hit.on_top ? high : 0.7 * high;
                } else {
                    low = high = full * 0.45;
                }
                ++compared;
                if (shown < low - 1.5 || shown > high + 1.5) ++wrong;
            }
        }
    }
    CHECK(compared > 3000);
    // Pixels at an edge belong to either side: 2048 columns around the mirror, steps of a fifth of a
    // millimetre.
    CHECK(wrong < compared * 0.02);
}

TEST_CASE("a light is seen where it is, as large as it is, and not through bodies") {
    Random random(42);
    int hidden = 0;
    for (int i = 0; i < 60; ++i) {
        World world = world_with_robot(2.0, 2.0);
        world.robots[0].heading = between(random, -3, 3);
        world.parameters["camera.noise"] = 0.0;
        world.ambient_light = 0.0;
        const double angle = between(random, -3, 3), distance = between(random, 0.1, 0.5);
        world.lamps.push_back(
            {.name = {}, .x = distance * std::cos(angle), .y = distance * std::sin(angle), .height = 0.06});
        const bool wall = i % 3 == 0;
        if (wall)
            world.boxes.push_back({.name = {},
                                   .x = 0.06 * std::cos(angle),
                                   .y = 0.06 * std::sin(angle),
                                   .heading = angle,
                                   .length = 0.005,
                                   .width = 0.2,
                                   .height = 0.2});
        const CameraScene scene(world);
        const ImageSize size{640, 480};
        CameraView view(CameraKind::Omni, scene, 0, "e1", 1);
        std::vector<std::uint8_t> rgb(size.width * size.height * 3);
        view.render(size, {}, 0, rgb);
        double sum_u = 0, sum_v = 0, area = 0;
        for (std::uint32_t v = 0; v < size.height; ++v)
            for (std::uint32_t u = 0; u < size.width; ++u)
                if (rgb[(v * size.width + u) * 3] > 128) {
                    sum_u += u + 0.5;
                    sum_v += v + 0.5;
                    ++area;
                }
        if (wall) {
            CHECK(area == 0);
            ++hidden;
            continue;
        }
        REQUIRE(area > 0);
        const double bearing = angle - world.robots[0].heading;
        const CameraParameters& p = scene.parameters(0).camera;
        const Optics optics(CameraKind::Omni, p, size);
        const auto point =
            optics.project(distance * std::cos(bearing), distance * std::sin(bearing), 0.06 - p.height);
        REQUIRE(point);
        CHECK(sum_u / area == Approx(point->u).margin(2.5));
        CHECK(sum_v / area == Approx(point->v).margin(2.5));
    }
    CHECK(hidden == 20);
}

TEST_CASE("noise is drawn per frame and camera, as strong as asked") {
    World world = world_with_robot(2.0, 2.0);
    world.arena.walls = false;
    world.parameters["camera.noise"] = 0.02;
    const CameraScene scene(world);
    const ImageSize size{160, 120};
    const auto picture = [&](const std::string& name, std::uint64_t seed, std::uint64_t frame) {
        CameraView view(CameraKind::Omni, scene, 0, name, seed);
        std::vector<std::uint8_t> rgb(size.width * size.height * 3);
        view.render(size, {}, frame, rgb);
        return rgb;
    };
    CHECK(picture("e1", 1, 5) == picture("e1", 1, 5));
    CHECK(picture("e1", 1, 5) != picture("e1", 1, 6));
    CHECK(picture("e1", 1, 5) != picture("e1", 2, 5));
    CHECK(picture("e1", 1, 5) != picture("e2", 1, 5));
    const auto one = picture("e1", 1, 5), other = picture("e1", 1, 6);
    double sum = 0, square = 0;
    int count = 0;
    for (std::size_t i = 0; i < one.size(); ++i) {
        if (one[i] < 80) continue;  // the floor, not its dark surroundings
        const double difference = static_cast<double>(one[i]) - other[i];
        sum += difference;
        square += difference * difference;
        ++count;
    }
    REQUIRE(count > 5000);
    CHECK(sum / count == Approx(0).margin(0.3));
    CHECK(std::sqrt(square / count / 2) == Approx(0.02 * 255).epsilon(0.05));
    // 16 more gain is twice as bright; contrast nothing is all grey.
    CameraView view(CameraKind::Front, scene, 0, "e1", 1);
    std::vector<std::uint8_t> low(size.width * size.height * 3), high(low.size());
    view.render(size, {.gain = 10}, 1, low);
    view.render(size, {.gain = 26}, 1, high);
    double sum_low = 0, sum_high = 0;
    for (std::size_t i = 0; i < low.size(); ++i) {
        sum_low += low[i];
        sum_high += high[i];
    }
    CHECK(sum_high / sum_low == Approx(2.0).epsilon(0.02));
    view.render(size, {.contrast = 0}, 1, low);
    CHECK(
        std::all_of(low.begin(), low.end(), [](std::uint8_t value) { return value == 127 || value == 128; }));
}
