#include "base/files/partial_file.h"

#include <system_error>

namespace puckloop {

namespace fs = std::filesystem;

void remove_partial(const fs::path& file) {
    std::error_code failed;
    // By its own name: of a link what it leads to is removed.
    const fs::path real = fs::canonical(file, failed);
    if (!failed && fs::is_regular_file(real, failed)) fs::remove(real, failed);
}

}  // namespace puckloop
