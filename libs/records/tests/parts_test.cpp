// Form of events and samples in the store, also of damaged ones.
#include "parts.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <random>

#include "metier/records/store.hpp"
#include "recorded.hpp"
#include "text.hpp"

namespace metier::records {
namespace {

TEST(Samples, ComeBackBitByBit) {
    const std::array numbers{0.1, -0.0, 1e-300, std::numeric_limits<double>::infinity(),
                             3.0, 4.0,  5.0,    6.0};
    std::vector<PathSample> samples;
    Bytes bytes;
    for (std::size_t n = 0; n <= numbers.size(); ++n) {
        const auto some = std::span(numbers).first(n);
        samples.push_back({.time = 0.001 * static_cast<double>(n),
                           .actual = SampleValues(some),
                           .commanded = SampleValues(some.first(n / 2)),
                           .force = SampleValues(some.first(n / 3))});
        encodeSample(samples.back(), bytes);
    }
    std::vector<PathSample> read;
    decodeSamples(bytes, read);
    ASSERT_EQ(read.size(), samples.size());
    for (std::size_t i = 0; i < read.size(); ++i) {
        EXPECT_EQ(read[i].time, samples[i].time);
        EXPECT_EQ(read[i].actual, samples[i].actual);
        EXPECT_EQ(read[i].commanded, samples[i].commanded);
        EXPECT_EQ(read[i].force, samples[i].force);
    }
}

TEST(RecordsUrl, ShowsItsPassword) {
    for (const auto* url :
         {"postgresql://anna:secret@db/records", "postgres://anna:@db", "postgresql://anna:a/b@db",
          "postgresql://anna@db/records?password=secret", "postgresql:///r?a=b&password=x",
          "postgresql://anna@db/records?sslpassword=secret"}) {
        EXPECT_TRUE(hasPassword(url)) << url;
    }
    for (const auto* url :
         {"postgresql://anna@db:5432/records", "postgresql://db:5432/r?sslmode=verify-full",
          "postgresql://[::1]:5432/records", "sqlite:a:b@c", "records.db", "off", ""}) {
        EXPECT_FALSE(hasPassword(url)) << url;
    }
}

TEST(Samples, EndWhereTheyAreDamaged) {
    Bytes bytes;
    encodeSample(sampleAt(1, 2), bytes);
    const auto one = bytes.size();
    encodeSample(sampleAt(2, 3), bytes);
    std::vector<PathSample> read;
    decodeSamples(Bytes(bytes.begin(), bytes.end() - 1), read);
    EXPECT_EQ(read.size(), 1U);
    bytes[one] = 9;  // more axes than there are
    read.clear();
    decodeSamples(bytes, read);
    EXPECT_EQ(read.size(), 1U);
}

TEST(Samples, MayBeAnyBytes) {
    std::mt19937 random(7);  // NOLINT(*-msc51-cpp): the same each time
    std::uniform_int_distribution<int> byte(0, 255);
    std::uniform_int_distribution<int> small(0, 9);
    for (int i = 0; i < 2'000; ++i) {
        Bytes bytes;
        for (int size = small(random) * 20; size >= 0; --size) {
            const bool count = size % 7 == 0;
            bytes.push_back(static_cast<std::uint8_t>(count ? small(random) : byte(random)));
        }
        std::vector<PathSample> read;
        decodeSamples(bytes, read);
        EXPECT_LE(read.size() * 11, bytes.size());
    }
}

TEST(Events, ThatAreNoneArePassedOver) {
    std::vector<Event> events;
    for (const auto* text :
         {"", "no JSON", "{}", "[1,null,[],[\"t\"]]", "[[\"t\",1,2,3,4,5,6,7]]",
          "[[\"t\",\"1\",\"\",\"\",\"\",\"\",\"\",\"\"]]", "[[\"i\",1]]", "[[\"x\",1,\"2\"]]"}) {
        decodeEvents(text, events);
    }
    EXPECT_TRUE(events.empty());
    decodeEvents(R"([["i",5,"7"],["i"]])", events);
    ASSERT_EQ(events.size(), 1U);
    EXPECT_EQ(std::get<Intermediate>(events[0]).value, "7");
}

TEST(Times, KeepTheirMicroseconds) {
    EXPECT_EQ(fromMicroseconds(toMicroseconds(at(1))), at(1));
    EXPECT_EQ(toMicroseconds({}), 0);
    EXPECT_EQ(toMicroseconds(fromMicroseconds(-1)), -1);
}

TEST(Storable, KeepsWellFormedTextAndReplacesTheRest) {
    const std::string bad = "\xEF\xBF\xBD";
    EXPECT_EQ(storable("a\xC3\xA9\xE2\x82\xAC\xF0\x9F\xA4\x96\n"),
              "a\xC3\xA9\xE2\x82\xAC\xF0\x9F\xA4\x96\n");
    EXPECT_EQ(storable("\xFF"), bad);
    EXPECT_EQ(storable("\xC0\xAF"), bad + bad);                      // overlong
    EXPECT_EQ(storable("\xED\xA0\x80"), bad + bad + bad);            // surrogate
    EXPECT_EQ(storable("\xF4\x90\x80\x80"), bad + bad + bad + bad);  // beyond U+10FFFF
    EXPECT_EQ(storable("\xE2\x82"), bad);                            // cut off
    EXPECT_EQ(storable(std::string_view("\0", 1)), bad);
}

TEST(Storable, IsCutBetweenCharacters) {
    EXPECT_EQ(storable("ab\xC3\xA9", 3), "ab");
    EXPECT_EQ(storable("ab\xC3\xA9", 4), "ab\xC3\xA9");
    EXPECT_EQ(storable("\xFF\xFF", 5), "\xEF\xBF\xBD");
}

TEST(Storable, IsMadeOfEveryTextOfARecord) {
    auto execution = moveOf("id\xFF");
    execution.skill = std::string(5'000, 's');
    execution.reason_text = std::string(5'000, 'r');
    execution.parameters = std::string(5'000, 'p');
    execution.user = std::string("a\0b", 3);
    makeStorable(execution);
    EXPECT_EQ(execution.id, "id\xEF\xBF\xBD");
    EXPECT_EQ(execution.skill.size(), 300U);
    EXPECT_EQ(execution.reason_text.size(), 2'000U);
    EXPECT_EQ(execution.parameters.size(), 5'000U);
    EXPECT_EQ(execution.user,
              "a\xEF\xBF\xBD"
              "b");
    EXPECT_EQ(execution.client_name, moveOf("").client_name);
}

TEST(Events, ComeBackWithWhateverTheirTextsHold) {
    const std::string text = "\"quoted\" \\ \n \x01 \xC3\xA9";
    std::vector<Event> events{Transition{at(1), "Running", "Halted", "", text, "Error", text},
                              Intermediate{at(2), R"({"Width":"\"0.02\""})"}};
    std::vector<Event> read;
    decodeEvents(encodeEvents(events), read);
    ASSERT_EQ(read.size(), 2U);
    const auto& transition = std::get<Transition>(read[0]);
    EXPECT_EQ(transition.time, at(1));
    EXPECT_EQ(transition.from, "Running");
    EXPECT_EQ(transition.to, "Halted");
    EXPECT_EQ(transition.sub_state, "");
    EXPECT_EQ(transition.step, text);
    EXPECT_EQ(transition.reason_text, text);
    EXPECT_EQ(std::get<Intermediate>(read[1]).value, R"({"Width":"\"0.02\""})");
}

}  // namespace
}  // namespace metier::records
