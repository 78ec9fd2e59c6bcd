#include "fake_controller.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>

namespace metier::ur_driver {

using namespace std::chrono_literals;

namespace {

constexpr auto kCycle = 8ms;
constexpr auto kSlice = 10ms;
constexpr int kScriptPatience = 12;
constexpr int kMostAhead = 3;

auto now() {
    return std::chrono::steady_clock::now();
}

std::uint64_t wordAt(const std::vector<std::byte>& bytes, std::size_t at, std::size_t size) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i) {
        value = value << 8U | std::to_integer<std::uint64_t>(bytes.at(at + i));
    }
    return value;
}

std::vector<std::string> splitNames(const std::string& text) {
    std::vector<std::string> names;
    std::size_t begin = 0;
    while (begin <= text.size()) {
        const auto end = std::min(text.find(',', begin), text.size());
        names.push_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    return names;
}

std::string typeOf(const std::string& name) {
    static const std::map<std::string, std::string> kTypes{
        {"timestamp", "DOUBLE"},     {"target_q", "VECTOR6D"},
        {"actual_q", "VECTOR6D"},    {"actual_qd", "VECTOR6D"},
        {"robot_mode", "INT32"},     {"safety_status", "INT32"},
        {"safety_mode", "INT32"},    {"runtime_state", "UINT32"},
        {"speed_scaling", "DOUBLE"}, {"target_speed_fraction", "DOUBLE"}};
    if (name.find("int_register_") != std::string::npos) {
        return "INT32";
    }
    if (name.find("double_register_") != std::string::npos) {
        return "DOUBLE";
    }
    const auto found = kTypes.find(name);
    return found == kTypes.end() ? "NOT_FOUND" : found->second;
}

std::vector<std::byte> versionMessage(int major) {
    return primaryPackage(20, WireBytes()
                                  .u64(1)
                                  .u8(254)
                                  .u8(3)
                                  .u8(9)
                                  .text("URControl")
                                  .u8(static_cast<unsigned>(major))
                                  .u8(15)
                                  .i32(8)
                                  .i32(106339)
                                  .text("Jan 1 2024")
                                  .bytes());
}

std::vector<std::byte> subPackage(int type, const std::vector<std::byte>& body) {
    return primaryPackage(type, body);  // the same header
}

std::vector<std::byte> robotState(const FakeController::Knobs& knobs) {
    constexpr double kHalfPi = 1.5707963267948966;
    WireBytes kinematics;
    for (unsigned i = 0; i < 6; ++i) {
        kinematics.u32(0xC0DE0000U + i);
    }
    kinematics.f64s(std::array<double, 6>{}).f64s(knobs.a);
    kinematics.f64s(std::array{0.089159, 0.0, 0.0, 0.10915, 0.09465, 0.0823});
    kinematics.f64s(std::array{kHalfPi, 0.0, 0.0, kHalfPi, -kHalfPi, 0.0}).u32(0);
    WireBytes configuration;
    for (int i = 0; i < 6; ++i) {
        configuration.f64(-6.3355).f64(6.3355);
    }
    for (int i = 0; i < 6; ++i) {
        configuration.f64(knobs.max_velocity).f64(40.0);
    }
    configuration.f64s(std::array<double, 29>{}).i32(0).i32(0).i32(1).i32(0);
    return primaryPackage(16, WireBytes()
                                  .append(subPackage(5, kinematics.bytes()))
                                  .append(subPackage(6, configuration.bytes()))
                                  .bytes());
}

}  // namespace

FakeController::FakeController() : FakeController(Knobs{}) {}

FakeController::FakeController(const Knobs& knobs) : knobs_(knobs) {
    listen();
    threads_.emplace_back(
        [this](const std::stop_token& s) { accept(0, &FakeController::serveRtde, s); });
    threads_.emplace_back(
        [this](const std::stop_token& s) { accept(1, &FakeController::servePrimary, s); });
    threads_.emplace_back(
        [this](const std::stop_token& s) { accept(2, &FakeController::serveScript, s); });
    threads_.emplace_back(
        [this](const std::stop_token& s) { accept(3, &FakeController::serveDashboard, s); });
}

FakeController::~FakeController() {
    for (auto& thread : threads_) {
        thread.request_stop();
    }
}

std::map<std::string, cell::Settings::Value> FakeController::settings() const {
    return {{"rtde_port", static_cast<double>(ports_[0].number())},
            {"primary_port", static_cast<double>(ports_[1].number())},
            {"secondary_port", static_cast<double>(ports_[2].number())},
            {"dashboard_port", static_cast<double>(ports_[3].number())},
            {"link_timeout", 2.0},
            {"receive_timeout", 0.2},
            {"unlock_delay", 0.0},
            {"frequency", 125.0}};
}

void FakeController::set(const std::function<void(Knobs&)>& change) {
    const std::lock_guard lock(mutex_);
    change(knobs_);
}

bool FakeController::await(const std::function<bool()>& reached) {
    const auto deadline = now() + 10s;
    while (now() < deadline) {
        if (reached()) {
            return true;
        }
        std::unique_lock lock(mutex_);
        cycled_.wait_for(lock, 20ms);
    }
    return reached();
}

void FakeController::switchOff() {
    const std::lock_guard lock(mutex_);
    ++generation_;
    for (auto& listener : listeners_) {
        listener.reset();
    }
}

void FakeController::listen() {
    const std::lock_guard lock(mutex_);
    for (std::size_t i = 0; i < kPorts; ++i) {
        listeners_[i] = std::make_unique<link::TcpListener>(
            link::TcpListener::listen("127.0.0.1", ports_[i].number()).value());
    }
}

void FakeController::breakRtde() {
    const std::lock_guard lock(mutex_);
    ++rtde_generation_;
}

void FakeController::sayError(std::int32_t code, std::int32_t argument, const std::string& text) {
    const std::lock_guard lock(mutex_);
    to_say_.push_back(primaryPackage(20, WireBytes()
                                             .u64(2)
                                             .u8(255)
                                             .u8(6)
                                             .i32(code)
                                             .i32(argument)
                                             .i32(3)
                                             .u32(0)
                                             .u32(0)
                                             .text(text)
                                             .bytes()));
}

int FakeController::uploads() const {
    const std::lock_guard lock(mutex_);
    return uploads_;
}

std::string FakeController::script() const {
    const std::lock_guard lock(mutex_);
    return script_;
}

std::array<double, 6> FakeController::target() const {
    const std::lock_guard lock(mutex_);
    return q_;
}

bool FakeController::programRuns() const {
    const std::lock_guard lock(mutex_);
    return knobs_.runtime == 2;
}

std::vector<std::byte> FakeController::lastInput() const {
    const std::lock_guard lock(mutex_);
    return last_input_;
}

std::vector<std::string> FakeController::commands() const {
    const std::lock_guard lock(mutex_);
    return commands_;
}

bool FakeController::paused() const {
    const std::lock_guard lock(mutex_);
    return !streaming_;
}

// ---- servers -----------------------------------------------------------------------------------

void FakeController::accept(std::size_t index, Serve serve, const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        Result<link::TcpLink> link = fail(Errc::timeout, "");
        {
            const std::lock_guard lock(mutex_);
            if (listeners_[index]) {
                link = listeners_[index]->accept(now());
            }
        }
        if (link) {
            (this->*serve)(*link, stop);
        } else {
            std::unique_lock lock(mutex_);
            cycled_.wait_for(lock, 2ms);
        }
    }
}

/// Answers the whole messages, and removes them.
std::vector<std::byte> FakeController::answerAll(std::vector<std::byte>& received) {
    std::vector<std::byte> out;
    while (received.size() >= 3 && received.size() >= wordAt(received, 0, 2)) {
        const auto size = static_cast<std::ptrdiff_t>(wordAt(received, 0, 2));
        const auto type = std::to_integer<std::uint8_t>(received[2]);
        const auto reply = answer(type, {received.begin() + 3, received.begin() + size});
        out.insert(out.end(), reply.begin(), reply.end());
        received.erase(received.begin(), received.begin() + size);
    }
    return out;
}

std::vector<std::byte> FakeController::dueData(SteadyTime& tick) {
    const auto time = now();
    if (time < tick) {
        return {};
    }
    tick = std::max(tick + kCycle, time + kCycle / 2);
    if (ahead()) {
        return {};
    }
    step();
    return dataPackage();
}

void FakeController::serveRtde(link::TcpLink& link, const std::stop_token& stop) {
    std::vector<std::byte> received;
    std::array<std::byte, 4096> chunk{};
    auto tick = now() + kCycle;
    std::uint64_t generation = 0;
    {
        const std::lock_guard lock(mutex_);
        streaming_ = false;
        unanswered_ = 0;
        generation = generation_ + rtde_generation_;
    }
    while (!stop.stop_requested()) {
        const auto count = link.receive(chunk, tick);
        std::vector<std::byte> out;
        {
            const std::lock_guard lock(mutex_);
            if (generation != generation_ + rtde_generation_ ||
                (!count && count.error().code != Errc::timeout)) {
                return;
            }
            received.insert(received.end(), chunk.begin(),
                            chunk.begin() + static_cast<std::ptrdiff_t>(count.value_or(0)));
            out = answerAll(received);
            const auto data = dueData(tick);
            out.insert(out.end(), data.begin(), data.end());
        }
        cycled_.notify_all();
        if (!out.empty()) {
            // To a driver that has gone: what it sent before is still received.
            static_cast<void>(link.send(out, now() + 1s));
        }
    }
}

std::vector<std::byte> FakeController::answer(std::uint8_t type,
                                              const std::vector<std::byte>& payload) {
    if (knobs_.silent && type != 'U') {
        return {};
    }
    const std::string text(reinterpret_cast<const char*>(payload.data()), payload.size());
    switch (type) {
        case 'V':
            return rtdePackage('V', WireBytes().u8(knobs_.accepts_version ? 1 : 0).bytes());
        case 'v':
            return rtdePackage('v', WireBytes().u32(knobs_.major).u32(15).u32(8).u32(1).bytes());
        case 'O':
            return knobs_.answers_recipes ? rtdePackage('O', setUp(text, 8, true))
                                          : std::vector<std::byte>{};
        case 'I':
            return rtdePackage('I', setUp(text, 0, false));
        case 'S':
            streaming_ = knobs_.accepts_start;
            return rtdePackage(knobs_.answers_start_as,
                               WireBytes().u8(knobs_.accepts_start ? 1 : 0).bytes());
        case 'P':
            streaming_ = false;
            return rtdePackage('P', WireBytes().u8(1).bytes());
        case 'U':
            takeInput(payload);
            return {};
        default:
            return {};
    }
}

std::vector<std::byte> FakeController::setUp(const std::string& names, std::size_t skip,
                                             bool outputs) {
    const auto list = splitNames(names.substr(skip));
    std::string types;
    bool valid = true;
    for (const auto& name : list) {
        auto type = knobs_.unknown.contains(name) ? "NOT_FOUND" : typeOf(name);
        type = knobs_.in_use.contains(name) ? "IN_USE" : type;
        valid = valid && type != "NOT_FOUND" && type != "IN_USE";
        types += (types.empty() ? "" : ",") + type;
    }
    if (outputs) {
        outputs_ = list;
    }
    return WireBytes().u8(valid ? (outputs ? 1 : 7) : 0).text(types).bytes();
}

void FakeController::takeInput(const std::vector<std::byte>& payload) {
    last_input_ = payload;
    unanswered_ = 0;
    token_register_ = static_cast<std::int32_t>(wordAt(payload, 1, 4));
    counter_register_ = static_cast<std::int32_t>(wordAt(payload, 5, 4));
    for (std::size_t i = 0; i < 6; ++i) {
        position_register_[i] = std::bit_cast<double>(wordAt(payload, 9 + 8 * i, 8));
    }
}

bool FakeController::ahead() const {
    return token_register_ != 0 && knobs_.runtime == 2 && unanswered_ >= kMostAhead;
}

void FakeController::step() {
    timestamp_ += 0.008;
    const bool safe = knobs_.safety_mode == 1 || knobs_.safety_mode == 2;
    if ((!safe || knobs_.robot_mode != 7) && knobs_.runtime == 2 && knobs_.pause_on_stop) {
        knobs_.runtime = 4;
    }
    const auto before = q_;
    if (knobs_.runtime == 2 && script_token_ != 0 && knobs_.takes) {
        runScript();
    }
    for (std::size_t i = 0; i < 6; ++i) {
        velocity_[i] = (before[i] - actual_[i]) / 0.008;
        actual_[i] = before[i];
    }
    velocity_[0] += knobs_.coasting;
}

void FakeController::runScript() {
    script_silence_ = counter_register_ == out_counter_ ? script_silence_ + 1 : 0;
    if (knobs_.obeys && (token_register_ != script_token_ || script_silence_ > kScriptPatience)) {
        knobs_.runtime = 1;
        script_token_ = 0;
        out_token_ = 0;
        return;
    }
    out_token_ = script_token_;
    out_counter_ = counter_register_;
    if (knobs_.follows && token_register_ == script_token_) {
        q_ = position_register_;
    }
}

std::vector<std::byte> FakeController::dataPackage() {
    if (!streaming_ || knobs_.silent) {
        return {};
    }
    if (knobs_.skip_cycles > 0) {
        --knobs_.skip_cycles;
        return {};
    }
    if (!knobs_.instead_of_data.empty()) {
        return knobs_.instead_of_data;
    }
    if (!knobs_.garbage.empty()) {
        return std::exchange(knobs_.garbage, {});
    }
    ++unanswered_;
    WireBytes data;
    data.u8(1);
    for (const auto& name : outputs_) {
        const std::map<std::string, std::function<void()>> kWriters{
            {"timestamp", [&] { data.f64(timestamp_); }},
            {"target_q", [&] { data.f64s(q_); }},
            {"actual_q", [&] { data.f64s(actual_); }},
            {"actual_qd", [&] { data.f64s(velocity_); }},
            {"robot_mode", [&] { data.i32(knobs_.robot_mode); }},
            {"safety_status", [&] { data.i32(knobs_.safety_mode); }},
            {"safety_mode", [&] { data.i32(knobs_.safety_mode); }},
            {"runtime_state", [&] { data.i32(knobs_.runtime); }},
            {"speed_scaling", [&] { data.f64(knobs_.scaling); }},
            {"target_speed_fraction", [&] { data.f64(knobs_.slider); }},
            {"output_int_register_24", [&] { data.i32(out_token_); }},
            {"output_int_register_25", [&] { data.i32(out_counter_); }},
        };
        kWriters.at(name)();
    }
    return rtdePackage('U', data.bytes());
}

void FakeController::servePrimary(link::TcpLink& link, const std::stop_token& stop) {
    std::array<std::byte, 4096> ignored{};
    std::vector<std::byte> out;
    std::uint64_t generation = 0;
    {
        const std::lock_guard lock(mutex_);
        generation = generation_;
        out = WireBytes()
                  .append(versionMessage(static_cast<int>(knobs_.major)))
                  .append(robotState(knobs_))
                  .bytes();
    }
    while (!stop.stop_requested() && link.send(out, now() + 1s)) {
        const auto count = link.receive(ignored, now() + kSlice);
        if (!count && count.error().code != Errc::timeout) {
            return;
        }
        const std::lock_guard lock(mutex_);
        if (generation != generation_) {
            return;
        }
        out = robotState(knobs_);
        for (const auto& message : std::exchange(to_say_, {})) {
            out.insert(out.end(), message.begin(), message.end());
        }
    }
}

void FakeController::serveScript(link::TcpLink& link, const std::stop_token& stop) {
    std::array<std::byte, 4096> chunk{};
    std::string text;
    while (!stop.stop_requested()) {
        const auto count = link.receive(chunk, now() + kSlice);
        if (!count && count.error().code != Errc::timeout) {
            return;
        }
        text.append(reinterpret_cast<const char*>(chunk.data()), count.value_or(0));
        if (text.size() < 5 || text.substr(text.size() - 5) != "\nend\n") {
            continue;
        }
        const std::lock_guard lock(mutex_);
        ++uploads_;
        script_ = std::exchange(text, {});
        if (knobs_.starts && knobs_.robot_mode == 7) {
            const auto at = script_.find("write_output_integer_register(24, ");
            script_token_ = std::atoi(script_.c_str() + at + 34);
            script_silence_ = 0;
            knobs_.runtime = 2;
        }
    }
}

void FakeController::serveDashboard(link::TcpLink& link, const std::stop_token& stop) {
    std::array<std::byte, 512> chunk{};
    std::string received;
    std::string out = "Connected: Universal Robots Dashboard Server\n";
    while (!stop.stop_requested()) {
        if (!link.send(std::as_bytes(std::span(out)), now() + 1s)) {
            return;
        }
        out.clear();
        const auto count = link.receive(chunk, now() + kSlice);
        if (!count && count.error().code != Errc::timeout) {
            return;
        }
        received.append(reinterpret_cast<const char*>(chunk.data()), count.value_or(0));
        const std::lock_guard lock(mutex_);
        for (auto end = received.find('\n'); end != std::string::npos; end = received.find('\n')) {
            const auto reply = obey(received.substr(0, end)) + "\n";
            out += knobs_.mute ? "" : reply;
            received.erase(0, end + 1);
        }
    }
}

std::string FakeController::obey(const std::string& command) {
    commands_.push_back(command);
    if (command == "is in remote control") {
        return knobs_.remote_control;
    }
    if (command == "unlock protective stop") {
        if (knobs_.unlocks && knobs_.unlock_reply == "Protective stop releasing") {
            knobs_.safety_mode = 1;
        }
        return knobs_.unlock_reply;
    }
    if (command == "power on") {
        knobs_.robot_mode = knobs_.powers_on ? 5 : knobs_.robot_mode;
        return knobs_.power_reply;
    }
    if (command == "brake release") {
        knobs_.robot_mode = knobs_.brake_reply == "Brake releasing" ? 7 : knobs_.robot_mode;
        return knobs_.brake_reply;
    }
    if (command == "stop") {
        knobs_.runtime = knobs_.stops ? 1 : knobs_.runtime;
        script_token_ = knobs_.stops ? 0 : script_token_;
        return knobs_.stop_reply;
    }
    if (command == "close safety popup") {
        return "closing safety popup";
    }
    return command == "close popup" ? "closing popup" : "could not understand: " + command;
}

}  // namespace metier::ur_driver
