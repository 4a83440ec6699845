// The calls on cameras. What they do is the device's business (devices/video_device.h); here they end or
// wait.

#include "linuxboard/shim/kernel/board_kernel.h"

#include <algorithm>
#include <cerrno>

namespace puckloop::linuxboard {

using cosim::kNever;
using cosim::Time;
using wire::Op;

bool BoardKernel::attempt_video(std::uint32_t thread, Waiting& waiting, Time now) {
    const wire::Request& request = waiting.request;
    const std::size_t number = files_[static_cast<std::size_t>(request.handle)].camera;
    VideoDevice& camera = *cameras_[number];
    const std::uint64_t memory = wire::video_offset(static_cast<std::uint32_t>(number));
    const bool nonblocking = request.nonblocking != 0;
    if (request.op == Op::Map) {
        const auto place = camera.map(request.a, request.b);
        finish(thread, static_cast<std::int64_t>(memory + place.value_or(0)), place ? 0 : EINVAL, now);
        return true;
    }
    if (request.op == Op::VideoRead) {
        const auto result = camera.read(request.handle, request.a, nonblocking, now);
        if (!result) return false;
        const std::uint64_t place = memory + result->place;
        finish(thread, result->bytes, result->error, now,
               std::string(reinterpret_cast<const char*>(&place), sizeof place));
        return true;
    }
    const auto error = camera.ioctl(request.handle, request.a, waiting.data, nonblocking, now);
    if (!error) return false;
    finish(thread, 0, *error, now, std::move(waiting.data));
    return true;
}

Time BoardKernel::next_frame() const {
    Time next = kNever;
    for (const auto& camera : cameras_)
        next = std::min(next, camera->next_event());
    return next;
}

}  // namespace puckloop::linuxboard
