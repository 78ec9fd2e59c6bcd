// Time that a set-point takes from the write of TargetJointPosition to the bytes on the maker's
// wire.
//
// For each robot `metier virtual run` runs its controller and `metier serve` its server with the
// real driver; a tap stands between the two and notes when each set-point passes. A client in this
// process streams a ramp p = p0 + v t of joint 1, where t is the time of the write. A set-point p
// that passes at t_wire is t_wire - (p - p0) / v old: that is the latency, whatever became of the
// set-point in between.
//
// - in step: the client writes half a cycle before the next set-point is due, as the tap saw it;
// - random phase: the client keeps its own time, five streams that begin anywhere in a cycle. The
//   wait for the next cycle alone is then spread evenly from 0 to one cycle;
// - interval: between set-points on the wire; its difference to the controller's cycle;
// - bare write: a write of a variable of a server of open62541 alone, there and back, in another
//   process. The ratio is that of the median in step to a lower bound: half a cycle of waiting and
//   such a write.
//
// `stream_latency [SECONDS]`: length of each stream, 8 by default.
#include <fmt/format.h>

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>

#include "bare.hpp"
#include "metier/client/kinematics_reader.hpp"
#include "metier/client/skill_handle.hpp"
#include "metier/link/child_process.hpp"
#include "metier/opcua/client.hpp"
#include "server_process.hpp"
#include "tap.hpp"

namespace metier::benchmarks {
namespace {

using namespace std::chrono_literals;
using std::chrono::steady_clock;
using Time = steady_clock::time_point;
using Millis = std::chrono::duration<double, std::milli>;

constexpr double kVelocity = 0.1;  // of the ramp [rad/s]
constexpr auto kLead = 500ms;      // of each stream; the follower gets up to speed in it
constexpr auto kPatience = 60s;
constexpr int kRandomStreams = 5;
constexpr int kBareWrites = 5000;

/// One robot with its controller.
struct Robot {
    std::string name;
    std::string type;  ///< type of its driver and its virtual controller
    std::string model;
    std::string address;  ///< of the controller, on this machine
    std::chrono::nanoseconds cycle;
    std::string port_setting;     ///< setting of the side that connects
    std::uint16_t port;           ///< of the side that listens; 0: a free one, published as `port`
    std::string driver_settings;  ///< more of them
    std::unique_ptr<SetPointReader> (*reader)();
};

const std::array kRobots{
    Robot{"UR5", "ur", "ur5", "127.0.77.1", 8ms, "rtde_port", 30004,
          "receive_timeout = 0.2, link_timeout = 1.0, servoj_lookahead = 0.03, servoj_gain = 2000",
          rtdeReader},
    Robot{"UR5e", "ur", "ur5e", "127.0.77.2", 2ms, "rtde_port", 30004,
          "receive_timeout = 0.2, link_timeout = 1.0, servoj_lookahead = 0.03, servoj_gain = 2000",
          rtdeReader},
    Robot{"iiwa 7", "iiwa", "iiwa7", "127.0.77.3", 10ms, "pc_port", 0, "answer_timeout_ms = 1000",
          libiiwaReader},
    Robot{"e.DO", "edo", "edo", "127.0.77.4", 10ms, "port", 9090,
          "joint_timeout = 1.0, machine_timeout = 5.0", rosbridgeReader},
};

[[noreturn]] void refuse(const std::string& what, const std::string& why) {
    throw std::runtime_error(what + ": " + why);
}

template <typename Answer>
auto require(const std::string& what, Answer answer) {
    if (!answer) {
        refuse(what, answer.error().message);
    }
    if constexpr (!std::is_void_v<typename Answer::value_type>) {
        return std::move(*answer);
    }
}

class Samples {
public:
    void add(double value) { values_.push_back(value); }
    double quantile(double fraction) {
        if (values_.empty()) {
            return std::nan("");
        }
        std::sort(values_.begin(), values_.end());
        return values_[static_cast<std::size_t>(fraction *
                                                static_cast<double>(values_.size() - 1))];
    }
    std::size_t size() const { return values_.size(); }

private:
    std::vector<double> values_;
};

struct Figures {
    Samples latency;   ///< [ms]
    Samples interval;  ///< off the cycle [ms]
};

// ---- what runs -------------------------------------------------------------------------------

/// The cell of one robot, with a tap between driver and controller.
class Cell {
public:
    explicit Cell(const Robot& robot)
        : robot_(robot),
          listening_(robot.port != 0 ? robot.port : freePort(robot.address)),
          tap_({robot.address, listening_,
                robot.port != 0 ? Tap::Dials::driver : Tap::Dials::controller, robot.reader}),
          file_(std::filesystem::temp_directory_path() /
                fmt::format("stream_latency_{}.toml", getpid())) {
        writeFile();
        controller_ = start({"virtual", "run", file_, "controller"});
        server_ = start({"serve", file_, "--port", "0"});
    }
    ~Cell() {
        std::error_code ignored;
        std::filesystem::remove(file_, ignored);
    }
    Cell(const Cell&) = delete;
    Cell& operator=(const Cell&) = delete;

    Tap& tap() { return tap_; }
    const std::string& url() const { return ready_; }

private:
    void writeFile() const {
        const auto model = fmt::format("{}/{}.toml", METIER_MODELS_DIR, robot_.model);
        const bool driver_dials = robot_.port != 0;
        const auto tapped = fmt::format("{} = {}", robot_.port_setting, tap_.port());
        std::ofstream out(file_);
        out << "name = \"latency\"\n[[virtual]]\nname = \"controller\"\ncontrol_port = 0\n"
            << fmt::format("type = \"{}\"\naddress = \"{}\"\nmodel = \"{}\"\n", robot_.type,
                           robot_.address, model)
            << (driver_dials ? "" : tapped) << "\n[[server]]\nname = \"arm\"\nkind = \"arm\"\n"
            << fmt::format("driver = {{ type = \"{}\", controller = \"controller\", {}, {} }}\n",
                           robot_.type,
                           driver_dials ? tapped : fmt::format("port = {}", listening_),
                           robot_.driver_settings)
            << fmt::format("model = \"{}\"\nskills = [\"PositionStreamSkill\"]\n", model)
            << "stream_silence = 1.0\n";
    }

    std::optional<link::ChildProcess> start(std::vector<std::string> arguments) {
        const auto what = arguments.front();
        arguments.insert(arguments.begin(), {METIER_PROGRAM, "--insecure-lab"});
        auto child = require("metier", link::ChildProcess::start(arguments));
        const auto line = require(what, child.readLine(steady_clock::now() + kPatience));
        ready_ = line.substr(line.find(' ') + 1);
        return child;
    }

    const Robot& robot_;
    std::uint16_t listening_;
    Tap tap_;
    std::filesystem::path file_;
    std::string ready_;
    std::optional<link::ChildProcess> controller_;
    std::optional<link::ChildProcess> server_;
};

/// The stream of one cell, as a client writes it.
class Stream {
public:
    explicit Stream(Cell& cell)
        : tap_(cell.tap()),
          client_(require("connecting", opcua::Client::connect(cell.url(), {}))),
          skill_(open(*client_)) {}

    /// Starts it where the arm stands, and writes that until set-points pass.
    void begin(const skill::Value& delay, std::chrono::nanoseconds cycle) {
        awaitReady();
        joints_ = measured();
        start_ = joints_[0];
        require("PlayOutDelay", skill_.set("PlayOutDelay", delay));
        require("Start", skill_.start());
        const auto give_up = steady_clock::now() + kPatience;
        const auto before = tap_.last();
        for (auto next = steady_clock::now(); tap_.last() == before; next += cycle) {
            std::this_thread::sleep_until(next);
            write(start_);
            if (steady_clock::now() > give_up) {
                refuse("the stream", "no set-point on the wire: " + skill_.reasonText());
            }
        }
    }

    void write(double position) {
        joints_[0] = position;
        require("writing", skill_.setAsync("TargetJointPosition", joints_,
                                           std::chrono::system_clock::now(), [](const auto&) {}));
    }

    void end() {
        require("Halt", skill_.halt());
        require("Halted", skill_.awaitState(skill::State::halted, steady_clock::now() + kPatience));
        require("Reset", skill_.reset());
    }

    double start() const { return start_; }
    Tap& tap() { return tap_; }
    bool running() { return require("state", skill_.state()) == skill::State::running; }
    std::string reason() { return skill_.reasonText(); }

private:
    static client::SkillHandle open(opcua::Client& client) {
        auto address = require("skill", client::findSkill(client, "PositionStreamSkill"));
        return require("skill", client::SkillHandle::open(client, std::move(address)));
    }

    std::vector<double> measured() {
        const auto nodes =
            require("kinematics", client::findKinematics(*client_, skill_.address()));
        return require("joints", client::readJointPosition(*client_, nodes));
    }

    /// The controller may still come up: a reset succeeds once it has.
    void awaitReady() {
        const auto give_up = steady_clock::now() + kPatience;
        while (require("state", skill_.state()) != skill::State::ready) {
            if (!skill_.reset()) {
                if (steady_clock::now() > give_up) {
                    refuse("not Ready", skill_.reasonText());
                }
                std::this_thread::sleep_for(100ms);
            }
        }
    }

    Tap& tap_;
    std::unique_ptr<opcua::Client> client_;
    client::SkillHandle skill_;
    std::vector<double> joints_;
    double start_ = 0;
};

// ---- streams ---------------------------------------------------------------------------------

/// Chooses the time of the next write.
using NextWrite = std::function<Time(Time last_write)>;

NextWrite inStep(Tap& tap, std::chrono::nanoseconds cycle) {
    return [&tap, cycle](Time last_write) {
        auto next = *tap.last() + cycle / 2;
        while (next < last_write + cycle / 2) {
            next += cycle;
        }
        return next;
    };
}

NextWrite onItsOwn(std::chrono::nanoseconds cycle) {
    return [cycle](Time last_write) { return last_write + cycle; };
}

struct Run {
    std::chrono::nanoseconds cycle;
    double velocity;  ///< of joint 1 [rad/s]
    std::chrono::nanoseconds length;
};

/// Streams a ramp from `begin` on. \return its end
Time writeRamp(Stream& stream, const Run& run, const NextWrite& next_write, Time begin) {
    for (Time next = begin; next < begin + run.length; next = next_write(next)) {
        std::this_thread::sleep_until(next);
        const std::chrono::duration<double> passed = steady_clock::now() - begin;
        stream.write(stream.start() + run.velocity * passed.count());
    }
    if (!stream.running()) {
        refuse("the stream ended", stream.reason());
    }
    return begin + run.length;
}

/// Streams a ramp and adds what passed, but for its beginning.
void measureRamp(Stream& stream, const Run& run, const NextWrite& next_write, Figures& figures) {
    static_cast<void>(stream.tap().take());
    const auto begin = steady_clock::now();
    const auto end = writeRamp(stream, run, next_write, begin);
    std::optional<Time> before;
    for (const auto& seen : stream.tap().take()) {
        if (seen.time < begin + kLead || seen.time > end) {
            continue;
        }
        const std::chrono::duration<double> meant((seen.position - stream.start()) / run.velocity);
        figures.latency.add(Millis(seen.time - begin - meant).count());
        if (before) {
            figures.interval.add(std::abs(Millis(seen.time - *before - run.cycle).count()));
        }
        before = seen.time;
    }
}

void print(const Robot& robot, const std::string& what, Figures& figures) {
    const double cycle = Millis(robot.cycle).count();
    auto& latency = figures.latency;
    auto& interval = figures.interval;
    fmt::print(
        "{:<8} {:<28} {:>7.2f} {:>7.2f} {:>7.2f}   {:>5.2f} {:>5.2f}   {:>6.2f} {:>6.2f} "
        "{:>6.2f}  {:>6}\n",
        robot.name, what, latency.quantile(0.5), latency.quantile(0.99), latency.quantile(1),
        latency.quantile(0.5) / cycle, latency.quantile(0.99) / cycle, interval.quantile(0.5),
        interval.quantile(0.99), interval.quantile(1), latency.size());
    static_cast<void>(std::fflush(stdout));
}

struct Delay {
    std::string name;
    skill::Value value;
};

/// \return the median in step without delay [ms]
double measure(const Robot& robot, std::chrono::nanoseconds length) {
    Cell cell(robot);
    Stream client(cell);
    std::mt19937_64 random(std::random_device{}());
    double velocity = kVelocity;
    double median = 0;
    for (const auto& delay : {Delay{"delay 0", 0.0}, Delay{"default delay", {}}}) {
        Figures in_step;
        client.begin(delay.value, robot.cycle);
        measureRamp(client, {robot.cycle, velocity, length}, inStep(cell.tap(), robot.cycle),
                    in_step);
        client.end();
        print(robot, delay.name + ", in step", in_step);
        if (delay.value == skill::Value(0.0)) {
            median = in_step.latency.quantile(0.5);
        }
        Figures anywhere;
        for (int i = 0; i < kRandomStreams; ++i) {
            velocity = -velocity;
            client.begin(delay.value, robot.cycle);
            std::this_thread::sleep_for(std::chrono::nanoseconds(
                random() % static_cast<std::uint64_t>(robot.cycle.count())));
            measureRamp(client, {robot.cycle, velocity, length / 2}, onItsOwn(robot.cycle),
                        anywhere);
            client.end();
        }
        print(robot, delay.name + ", random phase", anywhere);
    }
    return median;
}

// ---- baseline --------------------------------------------------------------------------------

/// \return median [ms]
double measureBareWrite(const ServerProcess& server) {
    opcua::bare::Client client(server.url());
    Samples times;
    for (int i = 0; i < kBareWrites; ++i) {
        const auto begin = steady_clock::now();
        client.writeParameter(i);
        times.add(Millis(steady_clock::now() - begin).count());
    }
    fmt::print("bare write, there and back: p50 {:.3f} ms, p99 {:.3f} ms, max {:.3f} ms\n\n",
               times.quantile(0.5), times.quantile(0.99), times.quantile(1));
    return times.quantile(0.5);
}

void run(double seconds) {
    const ServerProcess bare([] {
        const auto server = std::make_shared<opcua::bare::Server>();
        server->addPrograms(1);
        server->start();
        return Served{server->url(), server};
    });
    const double bare_write = measureBareWrite(bare);
    fmt::print("{:<8} {:<28} {:>23}   {:>11}   {:>20}\n", "", "", "latency [ms]", "[cycles]",
               "interval off [ms]");
    fmt::print("{:<8} {:<28} {:>7} {:>7} {:>7}   {:>5} {:>5}   {:>6} {:>6} {:>6}  {:>6}\n", "robot",
               "stream", "p50", "p99", "max", "p50", "p99", "p50", "p99", "max", "number");
    const auto length = std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 * seconds));
    for (const auto& robot : kRobots) {
        const double least = Millis(robot.cycle).count() / 2 + bare_write;
        const double median = measure(robot, length);
        fmt::print("{:<8} in step {:.2f} of half a cycle and a bare write, {:.2f} ms\n\n",
                   robot.name, median / least, least);
    }
}

}  // namespace
}  // namespace metier::benchmarks

int main(int count, char** arguments) {
    try {
        metier::benchmarks::run(count > 1 ? std::atof(arguments[1]) : 8.0);
    } catch (const std::exception& error) {
        fmt::print(stderr, "stream_latency: {}\n", error.what());
        return EXIT_FAILURE;
    }
    return EXIT_SUCCESS;
}
