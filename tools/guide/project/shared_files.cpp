// What projects of each kind have: CI, editor settings, the schema.

#include "base/version/version.h"
#include "tools/guide/project/new_files.h"
#include "tools/guide/schema/schemas.h"

#include <fmt/format.h>

namespace puckloop::tools {

namespace {

// NAME in each text is the project's name.

// Where the packages are differs: a laboratory's server, a release's page, a folder of the project itself.
constexpr std::string_view kInstall = R"sh(#!/bin/sh
# Installs puckloop's packages on Debian 12: from `packages` in this project, or from PUCKLOOP_PACKAGES, the address
# of a folder that has them (https://..., file:///...), with their SHA256SUMS. `./puckloop package` of puckloop's
# sources makes them.
set -eu
VERSION=PACKAGE_VERSION
here=$(cd "$(dirname "$0")/.." && pwd)
if [ -d "$here/packages" ]; then
    PUCKLOOP_PACKAGES=file://$here/packages
elif [ -z "${PUCKLOOP_PACKAGES:-}" ]; then
    echo "ci/install_puckloop.sh: no folder 'packages', and the variable PUCKLOOP_PACKAGES names no address" >&2
    exit 2
fi
export DEBIAN_FRONTEND=noninteractive
apt-get update -q
apt-get install -q -y --no-install-recommends ca-certificates curl python3
cd "$(mktemp -d)"
arch=$(dpkg --print-architecture)
curl -fsSLO "$PUCKLOOP_PACKAGES/SHA256SUMS"
for package in "puckloop_${VERSION}_$arch" "puckloop-firmware_${VERSION}_all" "python3-puckloop_${VERSION}_all"; do
    curl -fsSLO "$PUCKLOOP_PACKAGES/$package.deb"
done
sha256sum --check --ignore-missing SHA256SUMS
apt-get install -q -y --no-install-recommends ./*.deb
puckloop version
)sh";

constexpr std::string_view kGitHub = R"(name: robot
on: [push, pull_request]
jobs:
  test:
    runs-on: ubuntu-latest
    container: debian:12
    env:
      PUCKLOOP_PACKAGES: ${{ vars.PUCKLOOP_PACKAGES }} # see ci/install_puckloop.sh
    steps:
      - uses: actions/checkout@v4
      - run: ci/install_puckloop.sh
      - run: puckloop check NAME.toml
      - run: puckloop run NAME.toml --in-process --junit results.xml
      - run: python3 -m unittest -v
      - uses: actions/upload-artifact@v4
        if: failure()
        with:
          name: results
          path: |
            out
            results.xml
)";

constexpr std::string_view kGitLab = R"(test:
  image: debian:12
  before_script:
    - ci/install_puckloop.sh # PUCKLOOP_PACKAGES: a variable of the project's CI settings
  script:
    - puckloop check NAME.toml
    - puckloop run NAME.toml --in-process --junit results.xml
    - python3 -m unittest -v
  artifacts:
    when: always
    paths: [out]
    reports:
      junit: results.xml
)";

constexpr std::string_view kEditor = R"({
  "evenBetterToml.schema.associations": {
    ".*NAME\\.toml$": "./scenario.schema.json"
  },
  "files.associations": { "*.toml": "toml" }
}
)";

// "type" is what an editor's extension registers for the adapter; docs/debugger.md has the way for some.
constexpr std::string_view kLaunch = R"({
  "version": "0.2.0",
  "configurations": [
    {
      "name": "firmware on the e-puck's main board",
      "type": "puckloop",
      "request": "launch",
      "program": "IMAGE",
      "board": "pic",
      "sources": ["${workspaceFolder}/firmware"],
      "stopOnEntry": true
    }
  ]
}
)";

constexpr std::string_view kIgnored = "out/\nresults.xml\n__pycache__/\n*.o\ncontroller\n";

std::string replaced(std::string_view text, std::string_view place, std::string_view value) {
    std::string result;
    for (std::size_t at = 0;;) {
        const std::size_t found = text.find(place, at);
        result += text.substr(at, found - at);
        if (found == std::string_view::npos) return result;
        result += value;
        at = found + place.size();
    }
}

}  // namespace

std::string named(std::string_view text, std::string_view name) {
    return replaced(text, "NAME", name);
}

void add_shared_files(std::vector<NewFile>& files, std::string_view name, std::string_view image) {
    const std::string revision = "-1";  // of the packages, for one version
    files.insert(files.end(),
                 {{"ci/install_puckloop.sh",
                   replaced(kInstall, "PACKAGE_VERSION", program_version().number + revision), true},
                  {".github/workflows/puckloop.yml", named(kGitHub, name)},
                  {".gitlab-ci.yml", named(kGitLab, name)},
                  {".gitignore", std::string(kIgnored)},
                  {".vscode/settings.json", named(kEditor, name)},
                  {".vscode/launch.json", replaced(kLaunch, "IMAGE", image)},
                  {"scenario.schema.json", scenario_schema().dump(2) + "\n"}});
}

}  // namespace puckloop::tools
