#pragma once
// Descriptors of the program that stand for the node's devices. Behind each lies an open /dev/null, so that
// its number, dup(), close-on-exec and the like are the host's business.

#include "linuxboard/shim/preload/scheduler/scheduler.h"

#include <cstddef>
#include <cstdint>

namespace puckloop::shim {

/// Descriptors beyond this are the host's alone. Linux gives a process 1,024 unless it asks for more.
inline constexpr int kMostDescriptors = 4096;

/// One open file description; several descriptors may share it.
struct OpenFile {
    enum class Kind { Tty, I2c, Random, Video, Socket };
    Kind kind = Kind::Tty;
    const char* path = "";
    int handle = -1;
    int references = 0;
    int flags = 0;    ///< as F_GETFL shows them, without O_LARGEFILE
    int device = -1;  ///< index into the page's list; -1: none of the node's
    // i2c-dev, per open file
    std::uint16_t slave = 0;
    bool ten_bit = false;
    bool pec = false;
    // of a socket
    bool stream = false;
    bool netlink = false;  ///< its addresses are sockaddr_nl
};
inline constexpr const char* kSocketPath = "socket";

/// The device behind a descriptor, or nullptr. Always nullptr while nothing is conducted.
OpenFile* open_file(int fd);
/// The device a path names, or nullptr: index into the page's list, or kRandomDevice.
inline constexpr int kNoDevice = -1;
inline constexpr int kRandomDevice = -2;
/// A device of the node, named by a process that is outside of simulated time.
inline constexpr int kForbiddenDevice = -3;
int device_of(const char* path);
/// The descriptor of this process that a path in /dev/fd or /proc names, or -1.
int named_descriptor(const char* path);
/// The same for a path that begins at the open folder `folder`, as openat() takes it; without `follow` a
/// symbolic link to a device is none.
int device_at(int folder, const char* path, bool follow = true);

/// A new open file for the descriptor `fd` of the host; nullptr and EMFILE, and `fd` closed, if there is no
/// room.
OpenFile* adopt_descriptor(int fd);
/// Opens a device; a descriptor, or -1 and errno.
int open_device(int device, int flags);
/// One descriptor as a program leaves it to its successor in the same process.
struct FileEntry {
    int fd = -1;
    int same_as = -1;  ///< first descriptor of the same open file
    OpenFile file;
};
/// Number of descriptors written to `list`.
std::size_t open_files(FileEntry* list, std::size_t most);
/// Takes over what open_files() gave, except what the host has closed since (FD_CLOEXEC).
void take_over_files(FileEntry* list, std::size_t count);

/// A descriptor of the open file that the node knows as `handle`, or -1.
int descriptor_of(int handle);
/// Another descriptor for the same open file.
void share_file(int from, int to);
/// Forgets the descriptor; the last one closes the device. False if it is none of ours.
bool release_file(int fd);

/// A request about the file, which waits where its descriptor's flags do not forbid that.
wire::Request device_request(const OpenFile& file, wire::Op op);
std::int64_t read_device(OpenFile& file, void* buffer, std::size_t size);
std::int64_t write_device(OpenFile& file, const void* data, std::size_t size);
/// i2c_calls.cpp: one message each.
std::int64_t read_i2c(OpenFile& file, void* buffer, std::size_t size);
std::int64_t write_i2c(OpenFile& file, const void* data, std::size_t size);
/// video_calls.cpp: a frame, or what is left of it, and the ioctls of a camera.
std::int64_t read_video(OpenFile& file, void* buffer, std::size_t size);
int video_ioctl(OpenFile& file, unsigned long request, void* argument);
int device_ioctl(OpenFile& file, unsigned long request, void* argument, const void* caller);

/// "program+0x1234" or "main" of an address in the program.
const char* place_of(const void* address);

/// Deterministic bytes instead of the host's random ones.
void random_bytes(void* buffer, std::size_t size);
/// The same for a buffer of the program: as many as there is memory for, or -1 and EFAULT.
std::int64_t read_random(void* buffer, std::size_t size);

// network/data_calls.cpp: read(), write() and their kin on a socket, with the flags of recv() and send().
std::int64_t read_socket(OpenFile& file, void* buffer, std::size_t size, int flags);
std::int64_t write_socket(OpenFile& file, const void* data, std::size_t size, int flags);
// network/interface_calls.cpp
int socket_ioctl(OpenFile& file, unsigned long request, void* argument);

// waiting/epoll_calls.cpp
/// The descriptor is closed, or another file: nobody watches it any more.
void drop_watches(int fd);

}  // namespace puckloop::shim
