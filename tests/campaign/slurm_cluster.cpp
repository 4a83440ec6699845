#include "tests/campaign/slurm_cluster.h"

#include "base/random.h"

#include <fmt/format.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <thread>

#include <arpa/inet.h>
#include <pwd.h>
#include <sys/socket.h>
#include <unistd.h>

namespace puckloop::tests {

namespace fs = std::filesystem;

namespace {

/// Debian has the daemons where an ordinary user's PATH does not lead.
std::string program(const std::string& name) {
    for (const char* folder : {"/usr/sbin/", "/usr/bin/", "/usr/local/sbin/", "/usr/local/bin/"})
        if (::access((folder + name).c_str(), X_OK) == 0) return folder + name;
    return {};
}

/// A port that nobody listens on now.
int free_port() {
    const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    void* const raw = &address;
    ::bind(socket, static_cast<sockaddr*>(raw), size);
    ::getsockname(socket, static_cast<sockaddr*>(raw), &size);
    ::close(socket);
    return ntohs(address.sin_port);
}

}  // namespace

SlurmCluster::SlurmCluster(const fs::path& folder) : folder_(folder) {
    for (const char* name : {"munged", "slurmctld", "slurmd", "sbatch", "squeue", "scancel", "sinfo"})
        if (program(name).empty()) {
            missing_ = fmt::format("there is no {} (Debian: slurm-wlm, munge)", name);
            return;
        }
    start();
}

SlurmCluster::~SlurmCluster() {
    while (!daemons_.empty()) {  // the node first, the keys last
        daemons_.back()->signal(SIGTERM);
        daemons_.back()->wait(10);
        daemons_.pop_back();
    }
    ::unsetenv("SLURM_CONF");
}

Ended SlurmCluster::ask(const std::vector<std::string>& words) const {
    Process process(words, folder_);
    return process.wait(20);
}

void SlurmCluster::start() {
    char host[256] = "";
    ::gethostname(host, sizeof host - 1);
    const std::string name = std::string(host).substr(0, std::string(host).find('.'));
    const passwd* user = ::getpwuid(::geteuid());
    if (user == nullptr) {
        missing_ = "this user has no name";
        return;
    }
    for (const char* part : {"state", "spool", "munge", "controller", "node"})
        fs::create_directories(folder_ / part);
    fs::permissions(folder_, fs::perms(0755));  // munge wants a folder that others can pass and not write
    {
        RandomStream random(static_cast<std::uint64_t>(::getpid()), "munge key");
        std::ofstream key(folder_ / "munge.key", std::ios::binary);
        for (int i = 0; i < 128; ++i)
            key.put(static_cast<char>(random.below(256)));
    }
    fs::permissions(folder_ / "munge.key", fs::perms::owner_read);
    const std::string here = folder_.string();
    std::ofstream(folder_ / "slurm.conf") << fmt::format(
        "ClusterName=test\nSlurmctldHost={0}(127.0.0.1)\nSlurmUser={1}\nSlurmdUser={1}\n"
        "AuthType=auth/munge\nAuthInfo=socket={2}/munge.sock\nCredType=cred/munge\n"
        "SlurmctldPort={3}\nSlurmdPort={4}\n"
        "SlurmctldPidFile={2}/slurmctld.pid\nSlurmdPidFile={2}/slurmd.pid\n"
        "SlurmctldLogFile={2}/slurmctld.log\nSlurmdLogFile={2}/slurmd.log\n"
        "StateSaveLocation={2}/state\nSlurmdSpoolDir={2}/spool\n"
        "ProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\nSwitchType=switch/none\nMpiDefault=none\n"
        "SelectType=select/cons_tres\nSelectTypeParameters=CR_CPU\nReturnToService=2\n"
        "JobAcctGatherType=jobacct_gather/none\nAccountingStorageType=accounting_storage/none\n"
        "SchedulerParameters=sched_min_interval=100000\nKillWait=2\n"
        "NodeName={0} NodeAddr=127.0.0.1 CPUs={5} State=UNKNOWN\n"
        "PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP\n",
        name, user->pw_name, here, free_port(), free_port(),
        std::max(1U, std::thread::hardware_concurrency()));
    ::setenv("SLURM_CONF", (folder_ / "slurm.conf").c_str(), 1);
    const auto begin = [&](const char* place, std::vector<std::string> words) {
        daemons_.push_back(std::make_unique<Process>(words, folder_ / place));
    };
    begin("munge", {program("munged"), "--foreground", "--force", "--key-file=" + here + "/munge.key",
                    "--socket=" + here + "/munge.sock", "--pid-file=" + here + "/munged.pid",
                    "--seed-file=" + here + "/munge.seed"});
    for (int tries = 0; tries < 100 && !fs::exists(folder_ / "munge.sock"); ++tries)
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
    begin("controller", {program("slurmctld"), "-D", "-c"});
    begin("node", {program("slurmd"), "-D"});
    Ended last;
    for (int tries = 0; tries < 150; ++tries) {
        for (const auto& daemon : daemons_)
            if (!runs(daemon->id())) {
                missing_ = "a daemon of the cluster ended: " + daemon->wait(5).err.substr(0, 300);
                return;
            }
        last = ask({program("sinfo"), "--noheader", "--format", "%t"});
        if (last.status == 0 && last.out.find("idle") != std::string::npos) return;
        std::this_thread::sleep_for(std::chrono::milliseconds(200));
    }
    missing_ = "the cluster's node does not become idle: " + last.out + last.err.substr(0, 300);
}

}  // namespace puckloop::tests
