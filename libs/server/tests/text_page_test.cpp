#include "metrics/text_page.hpp"

#include <gmock/gmock.h>

#include <limits>

namespace metier::server {
namespace {

using testing::HasSubstr;

TEST(TextPage, TellsOfAFamilyAndItsFigures) {
    TextPage page;
    page.family("metier_starts_total", MetricKind::counter, "Executions that began.");
    page.add({{"skill", "Move"}}, std::uint64_t{3});
    page.add({}, std::uint64_t{4});
    page.family("metier_width", MetricKind::gauge, "Width [m].");
    page.add({}, 0.25);
    EXPECT_EQ(page.text(),
              "# HELP metier_starts_total Executions that began.\n"
              "# TYPE metier_starts_total counter\n"
              "metier_starts_total{skill=\"Move\"} 3\n"
              "metier_starts_total 4\n"
              "# HELP metier_width Width [m].\n"
              "# TYPE metier_width gauge\n"
              "metier_width 0.25\n");
}

TEST(TextPage, EscapesWhatALabelMayNotHold) {
    TextPage page;
    page.family("a", MetricKind::gauge, "a \\ of\ntwo lines");
    page.add({{"text", "say \"no\"\\\n"}}, 1.0);
    EXPECT_THAT(page.text(), HasSubstr("# HELP a a \\\\ of\\ntwo lines\n"));
    EXPECT_THAT(page.text(), HasSubstr("a{text=\"say \\\"no\\\"\\\\\\n\"} 1\n"));
}

TEST(TextPage, WritesWhatIsNotANumber) {
    TextPage page;
    page.family("a", MetricKind::gauge, "");
    page.add({}, std::numeric_limits<double>::quiet_NaN());
    page.add({}, std::numeric_limits<double>::infinity());
    page.add({}, -std::numeric_limits<double>::infinity());
    EXPECT_THAT(page.text(), HasSubstr("a NaN\na +Inf\na -Inf\n"));
}

TEST(TextPage, CumulatesTheBucketsOfAHistogram) {
    TimeHistogram times;
    times.add(0.001);
    times.add(0.003);
    times.add(1000.0);
    TextPage page;
    page.family("t_seconds", MetricKind::histogram, "Times.");
    page.add({{"skill", "Move"}}, times.read());
    EXPECT_THAT(page.text(), HasSubstr("t_seconds_bucket{skill=\"Move\",le=\"0.0005\"} 0\n"
                                       "t_seconds_bucket{skill=\"Move\",le=\"0.001\"} 1\n"
                                       "t_seconds_bucket{skill=\"Move\",le=\"0.002\"} 1\n"
                                       "t_seconds_bucket{skill=\"Move\",le=\"0.005\"} 2\n"));
    EXPECT_THAT(page.text(), HasSubstr("t_seconds_bucket{skill=\"Move\",le=\"100\"} 2\n"
                                       "t_seconds_bucket{skill=\"Move\",le=\"+Inf\"} 3\n"
                                       "t_seconds_sum{skill=\"Move\"} 1000.004\n"
                                       "t_seconds_count{skill=\"Move\"} 3\n"));
}

}  // namespace
}  // namespace metier::server
