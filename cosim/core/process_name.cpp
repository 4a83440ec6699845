#include "cosim/core/process_name.h"

#include <sys/prctl.h>

namespace puckloop::cosim {

void name_thread(const std::string& name) {
    constexpr std::size_t kKept = 15;
    const std::string end = name.substr(name.size() > kKept ? name.size() - kKept : 0);
    prctl(PR_SET_NAME, end.c_str());
}

}  // namespace puckloop::cosim
