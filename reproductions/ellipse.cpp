#include "reproductions/ellipse.h"

#include <Eigen/Dense>

#include <cmath>
#include <numbers>

namespace puckloop::tools {

double Ellipse::area() const {
    return std::numbers::pi * major * minor;
}

std::optional<Ellipse> fit_ellipse(const std::vector<std::pair<double, double>>& points) {
    const auto count = static_cast<Eigen::Index>(points.size());
    if (count < 5) return std::nullopt;
    // Centred and scaled, so that squares and linear terms weigh alike.
    double mean_x = 0.0, mean_y = 0.0, scale = 0.0;
    for (const auto& [x, y] : points) {
        mean_x += x / static_cast<double>(count);
        mean_y += y / static_cast<double>(count);
    }
    for (const auto& [x, y] : points)
        scale = std::max({scale, std::abs(x - mean_x), std::abs(y - mean_y)});
    if (scale == 0.0) return std::nullopt;
    Eigen::MatrixX3d quadratic(count, 3), linear(count, 3);
    for (Eigen::Index i = 0; i < count; ++i) {
        const double x = (points[static_cast<std::size_t>(i)].first - mean_x) / scale;
        const double y = (points[static_cast<std::size_t>(i)].second - mean_y) / scale;
        quadratic.row(i) << x * x, x * y, y * y;
        linear.row(i) << x, y, 1.0;
    }
    const Eigen::Matrix3d s1 = quadratic.transpose() * quadratic, s2 = quadratic.transpose() * linear,
                          s3 = linear.transpose() * linear;
    const Eigen::FullPivLU<Eigen::Matrix3d> solver(s3);
    if (!solver.isInvertible()) return std::nullopt;
    const Eigen::Matrix3d to_linear = -solver.solve(s2.transpose());
    const Eigen::Matrix3d reduced = s1 + s2 * to_linear;
    Eigen::Matrix3d system;  // the constraint 4ac - b^2 = 1, inverted
    system << reduced.row(2) / 2, -reduced.row(1), reduced.row(0) / 2;
    const Eigen::EigenSolver<Eigen::Matrix3d> eigen(system);
    for (Eigen::Index k = 0; k < 3; ++k) {
        const Eigen::Vector3d q = eigen.eigenvectors().col(k).real();
        const double a = q[0], b = q[1], c = q[2], determinant = 4 * a * c - b * b;
        if (!(determinant > 1e-12)) continue;
        const Eigen::Vector3d l = to_linear * q;
        const double x = (b * l[1] - 2 * c * l[0]) / determinant, y = (b * l[0] - 2 * a * l[1]) / determinant;
        const double value = l[2] + (l[0] * x + l[1] * y) / 2;  // of the conic at its centre
        const double middle = (a + c) / 2, spread = std::hypot(a - c, b) / 2;
        const double first = -value / (middle + spread), second = -value / (middle - spread);
        if (!(first > 0.0 && second > 0.0)) continue;
        Ellipse found{mean_x + scale * x, mean_y + scale * y, 0.0, 0.0, 0.0};
        found.major = scale * std::sqrt(std::max(first, second));
        found.minor = scale * std::sqrt(std::min(first, second));
        // The major axis belongs to the smaller eigenvalue in size, whatever the conic's sign.
        const double sign = middle < 0.0 ? -1.0 : 1.0;
        found.angle = 0.5 * std::atan2(-sign * b, -sign * (a - c));
        return found;
    }
    return std::nullopt;
}

}  // namespace puckloop::tools
