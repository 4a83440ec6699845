#pragma once
// Files that puckloop makes: a link in their place is not followed, as it may lead to any file of the user.

#include <fcntl.h>

#include <cstdio>
#include <filesystem>
#include <string>

namespace puckloop {

/// open() for writing, made (mode 0666 less the umask) if it is not there; emptied with O_TRUNC. -1 and
/// errno on failure, ELOOP if the last name is a link. Links to what is no file (a device, a pipe) and those
/// under /dev, such as /dev/stdout, are followed.
int open_new_file(const std::filesystem::path& file, int flags = O_TRUNC);

/// The same as a stream for writing bytes; null and errno on failure.
std::FILE* new_file(const std::filesystem::path& file);

/// Makes `file` or empties it, for streams that open it then. RunError, "FILE: cannot be written: ...".
void make_new_file(const std::filesystem::path& file);

/// A link that open_new_file() does not follow.
bool is_refused_link(const std::filesystem::path& file);

/// strerror(), and of ELOOP what it means here: "is a link, which is not followed".
std::string why_not_written(int error);

}  // namespace puckloop
