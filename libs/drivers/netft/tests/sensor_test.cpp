#include <gmock/gmock.h>

#include <algorithm>
#include <future>

#include "fake_sensor.hpp"
#include "netft_sensor.hpp"
#include "web_page.hpp"

namespace metier::netft_driver::testing {
namespace {

using namespace std::chrono_literals;
using device::SafetyState;
using ::testing::HasSubstr;

class Sensor : public ::testing::Test {
protected:
    Sensor() {
        options.name = "wrist";
        options.host = "127.0.0.1";
        options.port = fake.port();
        options.calibration = Calibration{1e-3, 1e-3};
        // A busy machine is no silent sensor, nor one that takes no tare.
        options.silence = 10s;
        options.tare_wait = 10s;
    }

    void open() { sensor = std::make_unique<NetftSensor>(options); }

    /// Waits until `done`, which the sensor's own changes bring about.
    template <typename Done>
    bool eventually(Done done) {
        struct Bell {
            std::mutex mutex;
            std::condition_variable changed;
        };
        // Shared with a callback that may still run when the registration has ended.
        const auto bell = std::make_shared<Bell>();
        const auto watch =
            sensor->onSafetyChange([bell](const auto&) { bell->changed.notify_all(); });
        std::unique_lock lock(bell->mutex);
        const auto deadline = std::chrono::steady_clock::now() + 10s;
        while (!done() && std::chrono::steady_clock::now() < deadline) {
            bell->changed.wait_for(lock, 5ms);
        }
        return done();
    }
    bool reaches(SafetyState state) {
        return eventually([&] { return sensor->safety().state == state; });
    }

    FakeSensor fake;
    NetftOptions options;
    std::unique_ptr<NetftSensor> sensor;
};

TEST_F(Sensor, MeasuresInSi) {
    fake.setForce(-12'500);
    open();
    ASSERT_TRUE(reaches(SafetyState::normal)) << sensor->safety().text;
    const auto sample = sensor->sample();
    EXPECT_EQ(sample.health, SafetyState::normal);
    EXPECT_DOUBLE_EQ(sample.force[2], -12.5);
    EXPECT_TRUE(eventually([&] { return sensor->sample().sequence > sample.sequence + 5; }));
}

TEST_F(Sensor, AsksForRecordsUntilTheyCome) {
    fake.ignoreStarts(3);
    open();
    EXPECT_TRUE(reaches(SafetyState::normal)) << sensor->safety().text;
    EXPECT_TRUE(fake.got(2, 4));
}

TEST_F(Sensor, GivesUpAfterTenRequestsAndBeginsAnew) {
    fake.ignoreStarts(1000);
    open();
    ASSERT_TRUE(eventually([&] {
        return sensor->safety().text.find("no record after 10 requests") != std::string::npos;
    })) << sensor->safety().text;
    EXPECT_EQ(sensor->sample().health, SafetyState::disconnected);
    EXPECT_TRUE(fake.got(2, 10));
    fake.ignoreStarts(0);
    EXPECT_TRUE(reaches(SafetyState::normal));
}

TEST_F(Sensor, TellsAnErrorAndItsEnd) {
    open();
    ASSERT_TRUE(reaches(SafetyState::normal));
    fake.setStatus(0x80020000U);
    ASSERT_TRUE(reaches(SafetyState::fault));
    EXPECT_EQ(sensor->safety().text, "wrist: gauge saturation or A/D error (status 80020000)");
    EXPECT_EQ(sensor->sample().health, SafetyState::fault);
    EXPECT_EQ(sensor->tare().error().code, Errc::device_fault);
    fake.setStatus(0x80010000U);
    ASSERT_TRUE(reaches(SafetyState::normal)) << "a warning";
}

TEST_F(Sensor, BeginsInAFaultIfItHasOne) {
    fake.setStatus(0x80000004U);
    open();
    ASSERT_TRUE(reaches(SafetyState::fault));
    EXPECT_THAT(sensor->safety().text, HasSubstr("temperature"));
}

TEST_F(Sensor, ThatFallsSilentIsLostAndFoundAgain) {
    options.silence = 300ms;
    open();
    ASSERT_TRUE(reaches(SafetyState::normal));
    fake.silence(true);
    ASSERT_TRUE(reaches(SafetyState::disconnected));
    EXPECT_THAT(sensor->safety().text, HasSubstr("no record for 300 ms"));
    EXPECT_THAT(sensor->safety().text, HasSubstr("wrist: 127.0.0.1:"));
    EXPECT_EQ(sensor->sample().health, SafetyState::disconnected);
    EXPECT_EQ(sensor->tare().error().code, Errc::connection_lost);
    fake.silence(false);
    EXPECT_TRUE(reaches(SafetyState::normal));
}

TEST_F(Sensor, NotifiesOfALossByItself) {
    options.silence = 300ms;
    open();
    ASSERT_TRUE(reaches(SafetyState::normal));
    // Shared with the callback, which may run until the registration has ended.
    const auto lost = std::make_shared<std::promise<void>>();
    const auto watch =
        sensor->onSafetyChange([lost, told = false](const device::Safety& now) mutable {
            if (now.state == SafetyState::disconnected && !std::exchange(told, true)) {
                lost->set_value();
            }
        });
    fake.silence(true);
    EXPECT_EQ(lost->get_future().wait_for(10s), std::future_status::ready);
}

TEST_F(Sensor, GoesOnAfterRecordsThatAreLost) {
    open();
    ASSERT_TRUE(reaches(SafetyState::normal));
    const auto before = sensor->sample().sequence;
    fake.lose(3);
    EXPECT_TRUE(eventually([&] { return sensor->sample().sequence > before + 5; }));
    EXPECT_EQ(sensor->safety().state, SafetyState::normal);
}

TEST_F(Sensor, IsNotTroubledByWhatIsNoRecord) {
    open();
    ASSERT_TRUE(reaches(SafetyState::normal));
    fake.sendNonsense();
    const auto now = sensor->sample().sequence;
    EXPECT_TRUE(eventually([&] { return sensor->sample().sequence > now + 5; }));
    EXPECT_EQ(sensor->safety().state, SafetyState::normal);
}

TEST_F(Sensor, IsTared) {
    fake.setForce(12'000);
    open();
    ASSERT_TRUE(reaches(SafetyState::normal));
    const auto tared = sensor->tare();
    ASSERT_TRUE(tared) << tared.error().message;
    EXPECT_NEAR(sensor->sample().force[2], 0.0, 1e-9);
    EXPECT_TRUE(fake.got(0x42));
}

TEST_F(Sensor, TellsThatATareHadNoEffect) {
    fake.setForce(12'000);
    fake.setDeaf(true);
    open();
    ASSERT_TRUE(reaches(SafetyState::normal));
    const auto tared = sensor->tare();
    ASSERT_FALSE(tared);
    EXPECT_EQ(tared.error().code, Errc::timeout);
    EXPECT_THAT(tared.error().message, HasSubstr("wrist: after 3 requests"));
    EXPECT_TRUE(fake.got(0x42, 3));
}

TEST_F(Sensor, IsTaredOnlyWhenSomebodyAsks) {
    open();
    ASSERT_TRUE(reaches(SafetyState::normal));
    const auto passes = [&](std::uint64_t records) {
        const auto begin = sensor->sample().sequence;
        return eventually([&] { return sensor->sample().sequence > begin + records; });
    };
    EXPECT_TRUE(passes(20));
    EXPECT_EQ(fake.count(0x42), 0);
    EXPECT_TRUE(sensor->tare());
    EXPECT_TRUE(passes(20));
    const auto asked = fake.count(0x42);  // more than once if the records were late
    EXPECT_GE(asked, 1);
    EXPECT_TRUE(passes(200)) << "longer than until a request is repeated";
    EXPECT_EQ(fake.count(0x42), asked);
}

TEST_F(Sensor, TaresForAllWhoAskMeanwhile) {
    fake.setForce(12'000);
    fake.ignoreTares(1);  // time for the second: the request is repeated after 150 ms
    open();
    ASSERT_TRUE(reaches(SafetyState::normal));
    auto first = std::async(std::launch::async, [&] { return sensor->tare(); });
    ASSERT_TRUE(fake.got(0x42));
    auto second = std::async(std::launch::async, [&] { return sensor->tare(); });
    EXPECT_TRUE(first.get());
    EXPECT_TRUE(second.get());
    EXPECT_NEAR(sensor->sample().force[2], 0.0, 1e-9);
}

TEST_F(Sensor, TellsATareThatDoesNotEndWithinASecond) {
    options.tare_wait = 1s;
    fake.setForce(12'000);  // also in records that are still on their way
    fake.setDeaf(true);
    open();
    ASSERT_TRUE(reaches(SafetyState::normal));
    fake.silence(true);
    const auto tared = sensor->tare();
    fake.silence(false);
    ASSERT_FALSE(tared);
    EXPECT_EQ(tared.error().code, Errc::timeout);
    EXPECT_EQ(tared.error().message, "wrist: no end of tare within 1 s");
}

TEST_F(Sensor, TellsATareWhoseRecordsNoLongerCome) {
    options.silence = 300ms;
    fake.setForce(12'000);
    fake.setDeaf(true);
    fake.fallSilentAtTare();
    open();
    ASSERT_TRUE(reaches(SafetyState::normal));
    EXPECT_EQ(sensor->tare().error().code, Errc::connection_lost);
    EXPECT_TRUE(fake.got(0x42));
}

TEST_F(Sensor, TellsThatNobodyReceivesItsRequests) {
    options.port = 1;
    open();
    EXPECT_TRUE(eventually([&] {
        return sensor->safety().text.find("Connection refused") != std::string::npos;
    })) << sensor->safety().text;
}

TEST_F(Sensor, TellsAHostThatHasNoAddress) {
    options.host = "no host";
    open();
    EXPECT_TRUE(eventually([&] {
        return sensor->safety().text.find("wrist: no host") != std::string::npos;
    })) << sensor->safety().text;
    EXPECT_EQ(sensor->safety().state, SafetyState::disconnected);
}

TEST_F(Sensor, AsksNoMoreOnceItIsShutDown) {
    fake.ignoreStarts(1000);
    int fewest = 1000;
    for (int i = 0; i < 5 && fewest >= 10; ++i) {  // one is not held up by other work
        const int before = fake.count(2);
        const int ends = fake.count(0);
        open();
        ASSERT_TRUE(fake.got(2, before + 1));
        sensor.reset();
        ASSERT_TRUE(fake.got(0, ends + 1)) << "the last that it sends";
        fewest = std::min(fewest, fake.count(2) - before);
    }
    EXPECT_LT(fewest, 10);
}

TEST_F(Sensor, EndsItsStream) {
    open();
    ASSERT_TRUE(reaches(SafetyState::normal));
    sensor.reset();
    EXPECT_TRUE(fake.got(0));
}

std::string page(const std::string& unit) {
    return ok("<netft><cfgcpf>1000</cfgcpf><cfgcpt>1000</cfgcpt><scfgfu>" + unit +
              "</scfgfu><scfgtu>Nm</scfgtu></netft>");
}

TEST_F(Sensor, ReadsItsCalibrationFromItsPage) {
    WebPage web({{"/netftapi2.xml", page("lbf")}});
    options.calibration.reset();
    options.http_port = web.port();
    fake.setForce(1'000);
    open();
    ASSERT_TRUE(reaches(SafetyState::normal)) << sensor->safety().text;
    EXPECT_NEAR(sensor->sample().force[2], 4.4482216152605, 1e-9);
}

TEST_F(Sensor, ReadsTheOlderPageIfThereIsNoNewer) {
    WebPage web({{"/netftcalapi.xml", ok("<netftCalibration><calcpf>10</calcpf><calcpt>10"
                                         "</calcpt></netftCalibration>")}});
    options.calibration.reset();
    options.units = {"N", "Nm"};
    options.http_port = web.port();
    fake.setForce(1'000);
    open();
    ASSERT_TRUE(reaches(SafetyState::normal)) << sensor->safety().text;
    EXPECT_NEAR(sensor->sample().force[2], 100.0, 1e-9);
}

TEST_F(Sensor, AsksForTheOlderPageOnlyIfTheNewerOneIsNotThere) {
    WebPage web({{"/netftapi2.xml", std::string("SSH-2.0-x\r\n\r\n")}});
    options.calibration.reset();
    options.http_port = web.port();
    open();
    ASSERT_TRUE(eventually([&] {
        return sensor->safety().text.find("/netftapi2.xml: no HTTP answer") != std::string::npos;
    })) << sensor->safety().text;
}

TEST_F(Sensor, DoesNotGuessItsCalibration) {
    WebPage web({});
    options.calibration.reset();
    options.http_port = web.port();
    open();
    ASSERT_TRUE(eventually([&] {
        return sensor->safety().text.find("HTTP status 404") != std::string::npos;
    })) << sensor->safety().text;
    EXPECT_EQ(sensor->sample().health, SafetyState::disconnected);
    web.set("/netftapi2.xml", page("kg"));
    ASSERT_TRUE(eventually([&] {
        return sensor->safety().text.find("unknown force unit 'kg'") != std::string::npos;
    })) << sensor->safety().text;
    web.set("/netftapi2.xml", page("N"));
    EXPECT_TRUE(reaches(SafetyState::normal));
}

/// As page(), with more elements.
std::string pageWith(const std::string& elements) {
    return ok(
        "<netft><cfgcpf>1000</cfgcpf><cfgcpt>1000</cfgcpt><scfgfu>N</scfgfu>"
        "<scfgtu>Nm</scfgtu>" +
        elements + "</netft>");
}

TEST_F(Sensor, WaitsFivePeriodsOfTheRateOnItsPage) {
    WebPage web({{"/netftapi2.xml", pageWith("<comrdtrate>10</comrdtrate>")}});
    options.calibration.reset();
    options.silence.reset();
    options.http_port = web.port();
    open();
    ASSERT_TRUE(reaches(SafetyState::normal)) << sensor->safety().text;
    fake.silence(true);
    ASSERT_TRUE(reaches(SafetyState::disconnected));
    EXPECT_THAT(sensor->safety().text, HasSubstr("no record for 500 ms"));
}

TEST_F(Sensor, WaitsByTheRateOfItsSettings) {
    WebPage web({{"/netftapi2.xml", pageWith("<comrdtrate>1</comrdtrate>")}});
    options.calibration.reset();
    options.silence.reset();
    options.rate = 20.0;
    options.http_port = web.port();
    open();
    ASSERT_TRUE(reaches(SafetyState::normal)) << sensor->safety().text;
    fake.silence(true);
    ASSERT_TRUE(reaches(SafetyState::disconnected));
    EXPECT_THAT(sensor->safety().text, HasSubstr("no record for 250 ms"));
}

TEST_F(Sensor, TellsThatRdtIsNotEnabled) {
    WebPage web({{"/netftapi2.xml", pageWith("<comrdte>Disabled</comrdte>")}});
    options.calibration.reset();
    options.http_port = web.port();
    open();
    ASSERT_TRUE(eventually([&] {
        return sensor->safety().text.find("RDT is not enabled") != std::string::npos;
    })) << sensor->safety().text;
    web.set("/netftapi2.xml", pageWith("<comrdte>Enabled</comrdte>"));
    EXPECT_TRUE(reaches(SafetyState::normal));
}

TEST_F(Sensor, ReadsItsCalibrationAnewAfterALoss) {
    WebPage web({{"/netftapi2.xml", page("N")}});
    options.calibration.reset();
    options.silence = 300ms;
    options.http_port = web.port();
    fake.setForce(1'000);
    open();
    ASSERT_TRUE(reaches(SafetyState::normal));
    web.set("/netftapi2.xml", page("kN"));
    fake.silence(true);
    ASSERT_TRUE(reaches(SafetyState::disconnected));
    fake.silence(false);
    ASSERT_TRUE(reaches(SafetyState::normal));
    EXPECT_NEAR(sensor->sample().force[2], 1000.0, 1e-9);
}

}  // namespace
}  // namespace metier::netft_driver::testing
