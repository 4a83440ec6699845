"""The Debian packages of a build: content, lintian, and a bare Debian 12 in which they are installed, run and removed.

Installing needs root, debootstrap and a network; without one of them it is skipped."""

import gzip
import json
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import time
import unittest

BUILD = pathlib.Path(os.environ["PUCKLOOP_BUILD"])
VERSION = os.environ["PUCKLOOP_VERSION"]
NAMES = ("puckloop", "puckloop-doc", "puckloop-firmware", "puckloop-gap", "puckloop-mpi", "python3-puckloop")
LIBRARIES = ("xbyak", "CLI11", "toml11", "JSON for Modern C++", "spdlog", "fmt", "pugixml", "Boost", "Eigen", "ODE", "nettle",
             "libelf", "libzip", "libpng", "SQLite", "zlib", "libedit")


def output(*words, **options):
    return subprocess.run(words, capture_output=True, text=True, check=True, **options).stdout


class Packages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        if shutil.which("dpkg-shlibdeps") is None or shutil.which("cpack") is None:
            raise unittest.SkipTest("there is no dpkg-shlibdeps (package dpkg-dev) or no cpack")
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        subprocess.run(["cmake", "--build", BUILD, "--target", "package_product"], check=True, capture_output=True)
        subprocess.run(["cpack", "--config", BUILD / "CPackConfig.cmake", "-B", cls.folder / "made"], check=True,
                       capture_output=True, cwd=BUILD, env={**os.environ, "SOURCE_DATE_EPOCH": "1700000000"})
        cls.files = {file.name.split("_")[0]: file for file in (cls.folder / "made").glob("*.deb")}

    def field(self, package, name):
        return output("dpkg-deb", "--field", self.files[package], name).strip()

    def test_names_and_dependencies(self):
        self.assertEqual(sorted(self.files), list(NAMES))
        for package, file in self.files.items():
            self.assertEqual(self.field(package, "Version"), f"{VERSION}-1")
            architecture = "amd64|arm64" if package in ("puckloop", "puckloop-gap", "puckloop-mpi") else "all"
            self.assertRegex(self.field(package, "Architecture"), f"^({architecture})$")
            self.assertNotRegex(self.field(package, "Depends"), "g\\+\\+|gcc-12|cmake|-dev", file)
        self.assertIn("libode8", self.field("puckloop", "Depends"))
        self.assertNotIn("libcholmod", self.field("puckloop", "Depends"))
        self.assertIn("libcholmod3", self.field("puckloop-gap", "Depends"))
        self.assertNotIn("libopenmpi", self.field("puckloop", "Depends"))
        self.assertIn("libopenmpi3", self.field("puckloop-mpi", "Depends"))

    def test_notices(self):
        for package in NAMES:
            subprocess.run(["dpkg-deb", "-x", self.files[package], self.folder / "tree"], check=True)
        documents = self.folder / "tree" / "usr" / "share" / "doc"
        for package in NAMES:
            text = (documents / package / "copyright").read_text()
            self.assertIn("Permission is hereby granted, free of charge", text)
            self.assertIn("GNU General Public" if package == "puckloop-gap" else "MIT", text)
            self.assertIn(VERSION, gzip.decompress((documents / package / "changelog.Debian.gz").read_bytes()).decode())
        text = (documents / "puckloop" / "copyright").read_text()
        for library in LIBRARIES:
            self.assertIn(library, text)
        self.assertNotIn("SuiteSparse", text)
        self.assertIn("SuiteSparse", (documents / "puckloop-gap" / "copyright").read_text())
        self.assertIn("Open MPI", (documents / "puckloop-mpi" / "copyright").read_text())
        pages = [page.name for page in (self.folder / "tree" / "usr" / "share" / "man" / "man1").iterdir()]
        for page in ("puckloop.1.gz", "puckloop-run.1.gz", "puckloop-gap.1.gz", "puckloop-mpi.1.gz", "puckloop-mpi-run.1.gz"):
            self.assertIn(page, pages)
        for place in ("bash-completion/completions/puckloop", "zsh/vendor-completions/_puckloop",
                      "fish/vendor_completions.d/puckloop.fish", "libsigrokdecode/decoders/epuck_btcom/pd.py"):
            self.assertTrue((self.folder / "tree" / "usr" / "share" / place).is_file(), place)

    def test_lintian(self):
        if shutil.which("lintian") is None:
            self.skipTest("there is no lintian")
        ended = subprocess.run(["lintian", "--fail-on", "error", "--allow-root", *self.files.values()], capture_output=True,
                               text=True, check=False)
        self.assertEqual(ended.returncode, 0, ended.stdout + ended.stderr)

    def test_bare_system(self):
        if os.geteuid() != 0 or shutil.which("debootstrap") is None:
            self.skipTest("a bare system takes root and debootstrap")
        root = self.folder / "root"
        made = subprocess.run(["debootstrap", "--variant=minbase", "bookworm", root], capture_output=True, text=True, check=False)
        if made.returncode != 0:
            self.skipTest("debootstrap failed, perhaps for want of a network: " + made.stdout[-300:])
        for place in ("proc", "dev"):
            subprocess.run(["mount", "--rbind", "--make-rslave", f"/{place}", root / place], check=True)
            self.addCleanup(subprocess.run, ["umount", "-R", "-l", root / place], check=False)
        for name in ("resolv.conf", "hosts"):
            shutil.copy(f"/etc/{name}", root / "etc" / name)
        for proxy in pathlib.Path("/etc/apt/apt.conf.d").glob("*proxy*"):
            shutil.copy(proxy, root / "etc" / "apt" / "apt.conf.d")
        for file in self.files.values():
            shutil.copy(file, root / "tmp")

        def inside(text, status=0, user="root"):
            environment = {name: os.environ[name] for name in os.environ if name.lower().endswith("_proxy")}
            ended = subprocess.run(["chroot", f"--userspec={user}", root, "/bin/sh", "-c", text], capture_output=True, text=True,
                                   check=False, stdin=subprocess.DEVNULL,
                                   env={**environment, "PATH": "/usr/sbin:/usr/bin:/sbin:/bin", "HOME": "/tmp/home", "LC_ALL": "C.UTF-8",
                                        "DEBIAN_FRONTEND": "noninteractive"})
            self.assertEqual(ended.returncode, status, f"{text}\n{ended.stdout[-3000:]}\n{ended.stderr[-3000:]}")
            return ended.stdout + ended.stderr

        before = inside("find / -xdev -not -path '/proc/*' -not -path '/tmp/*' -not -path '/var/*'| sort").splitlines()
        inside("apt-get update")
        start = time.monotonic()
        inside("apt-get install -y --no-install-recommends /tmp/puckloop_*.deb /tmp/puckloop-firmware_*.deb")
        installed = time.monotonic()
        inside("! command -v gcc && ! command -v c++ && ! command -v python3")
        inside("mkdir -p /tmp/elsewhere /tmp/home && chown nobody /tmp/elsewhere /tmp/home")
        text = inside("cd /tmp/elsewhere && puckloop run hello.toml", user="nobody:nogroup")
        moved = time.monotonic()
        print(f"package to moving robot: {installed - start:.1f} s to install, {moved - installed:.1f} s to run", flush=True)
        self.assertTrue((root / "tmp" / "elsewhere" / "out" / "hello" / "report.json").is_file(), text)
        self.assertLess(moved - start, 120)
        for words in ("list", "version", "check hello", "help run", "images", "disasm --help",
                      "run tam --duration 2", "run rab_pair --in-process --duration 2",
                      "exec /usr/share/puckloop/firmware/rab/rab.hex --seconds 0.1", "trace out/hello",
                      "view out/hello --export hello.html", "faults --help", "bench --help"):
            inside(f"cd /tmp/elsewhere && puckloop {words}", user="nobody:nogroup")
        self.assertIn("puckloop-gap", inside("cd /tmp/elsewhere && puckloop gap --help", status=2))
        inside("test -s /usr/share/man/man1/puckloop-run.1.gz")

        inside("apt-get install -y --no-install-recommends /tmp/*.deb")
        inside("cd /tmp/elsewhere && puckloop gap --help && puckloop gap record timing --brief --out recorded")
        inside("cd /tmp/elsewhere && python3 -c \"import puckloop; run = puckloop.start('hello'); run.step(to='1 s'); run.end()\"",
               user="nobody:nogroup")
        inside("cd /tmp/elsewhere && mpirun -n 2 --bind-to none --oversubscribe puckloop-mpi run rab_pair --duration 1 --out ranks"
               " && grep -q '\"success\": *true' ranks/report.json", user="nobody:nogroup")
        asked = json.dumps({"jsonrpc": "2.0", "id": 1, "method": "initialize",
                            "params": {"protocolVersion": "2024-11-05", "capabilities": {}, "clientInfo": {"name": "t", "version": "1"}}})
        self.assertIn("serverInfo", inside(f"cd /tmp/elsewhere && echo '{asked}' | puckloop mcp", user="nobody:nogroup"))

        inside(f"apt-get purge -y {' '.join(NAMES)} && apt-get autoremove -y --purge")
        after = inside("find / -xdev -not -path '/proc/*' -not -path '/tmp/*' -not -path '/var/*'| sort").splitlines()
        left = [name for name in sorted(set(after) - set(before)) if re.search("puckloop|epuck|xbee", name)]
        self.assertEqual(left, [])


if __name__ == "__main__":
    unittest.main()
