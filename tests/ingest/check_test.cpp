// On the shipped cases: no false alarm, and what is done to one of them is found.

#include "elrom/ingest/check.hpp"

#include <gmock/gmock.h>

#include <algorithm>

#include "outliers.hpp"
#include "unit_mistakes.hpp"

namespace elrom::ingest {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// The shipped cases, read once.
const std::vector<CfdCase>& shipped() {
  static const auto cases = [] {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(ELROM_SOURCE_DIR "/data/cases")) {
      if (entry.path().extension() == ".h5") files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    std::vector<CfdCase> result;
    for (const auto& file : files) result.push_back(read_el3d(file));
    return result;
  }();
  return cases;
}

std::vector<Finding> check(const std::vector<CfdCase>& cases) {
  Checker checker;
  for (const auto& one : cases) checker.add(view_of(one));
  return checker.findings();
}

/// The shipped cases with one of them changed.
template <class Change>
std::vector<Finding> check_with(std::size_t i_case, Change change) {
  Checker checker;
  for (std::size_t i = 0; i < shipped().size(); ++i) {
    if (i != i_case) {
      checker.add(view_of(shipped()[i]));
      continue;
    }
    auto one = shipped()[i];
    change(one);
    checker.add(view_of(one));
  }
  return checker.findings();
}

auto found(const std::string& kind, const std::string& case_name, const std::string& quantity) {
  return Contains(AllOf(Field(&Finding::kind, kind), Field(&Finding::case_name, case_name),
                        Field(&Finding::quantity, quantity)));
}

Eigen::Index row_of(const CfdCase& one, std::string_view field) {
  for (std::size_t f = 0; f < one.fields.size(); ++f) {
    if (one.fields[f].name == field) return static_cast<Eigen::Index>(f);
  }
  throw std::logic_error("no such field");
}

TEST(Check, ShippedCasesRaiseNoAlarm) {
  for (const auto& finding : check(shipped()))
    EXPECT_EQ(finding.severity, Severity::note) << line_of(finding);
}

TEST(Check, FewCasesRaiseNoAlarmEither) {
  for (const std::size_t n : {1u, 2u, 3u, 8u, 12u, 20u, 40u}) {
    for (std::size_t first = 0; first + n <= shipped().size(); first += 11) {
      const std::vector<CfdCase> some(shipped().begin() + static_cast<std::ptrdiff_t>(first),
                                      shipped().begin() + static_cast<std::ptrdiff_t>(first + n));
      for (const auto& finding : check(some)) {
        EXPECT_EQ(finding.severity, Severity::note) << n << " from " << first << ": " << line_of(finding);
      }
    }
  }
}

TEST(Check, NotFiniteCellsAreNamed) {
  const auto findings = check_with(7, [](CfdCase& one) {
    one.values(row_of(one, "pressure"), 123) = std::numeric_limits<float>::quiet_NaN();
    one.values(row_of(one, "pressure"), 456) = std::numeric_limits<float>::infinity();
  });

  const auto& name = shipped()[7].record.inputs.name;
  EXPECT_THAT(findings, Contains(AllOf(Field(&Finding::kind, "not_finite"), Field(&Finding::case_name, name),
                                       Field(&Finding::quantity, "pressure"), Field(&Finding::cell, 123),
                                       Field(&Finding::message, HasSubstr("2 cells")))));
}

TEST(Check, UnitMistakesOfEveryKindAreTold) {
  const auto input = [](const char* name, double factor, double offset) {
    return check_with(20, [=](CfdCase& one) {
      auto& value = one.record.inputs.values[one.schema.index_of(name)];
      value = factor * value + offset;
    });
  };
  const auto field = [](const char* name, float factor) {
    return check_with(20, [=](CfdCase& one) { one.values.row(row_of(one, name)) *= factor; });
  };
  const auto& name = shipped()[20].record.inputs.name;

  EXPECT_THAT(input("primary_air", 3.6, 0), found("unit", name, "primary_air"));
  EXPECT_THAT(input("fuel_front_left", 1 / 3.6, 0), found("unit", name, "fuel_front_left"));
  EXPECT_THAT(input("gas_temperature", 1, -273.15), found("unit", name, "gas_temperature"));
  EXPECT_THAT(input("solids_inventory", 1e-3, 0), found("unit", name, "solids_inventory"));
  EXPECT_THAT(input("solids_d50", 1e6, 0), found("unit", name, "solids_d50"));
  EXPECT_THAT(field("pressure", 1e-3f), found("unit", name, "pressure"));
  EXPECT_THAT(field("pressure", 1e5f), found("unit", name, "pressure"));
  EXPECT_THAT(field("solid_diameter", 1e6f), found("unit", name, "solid_diameter"));
  EXPECT_THAT(field("gas_velocity_z", 3.6f), found("unit", name, "gas_velocity_z"));
  EXPECT_THAT(field("solid_volume_fraction", 0.01f), found("unit", name, "solid_volume_fraction"));
}

TEST(Check, AUnitOfAllFlowsIsOneMistake) {
  const auto findings = check_with(20, [](CfdCase& one) {
    for (std::size_t i = 0; i < one.schema.size(); ++i)
      if (one.schema[i].unit == "kg/s") one.record.inputs.values[i] *= 3.6;
  });

  EXPECT_THAT(findings, found("unit", shipped()[20].record.inputs.name, "all gas flows"));
}

TEST(Check, AnInputFarFromWhatTheOthersMakeUsualIsTold) {
  const auto findings = check_with(
      20, [](CfdCase& one) { one.record.inputs.values[one.schema.index_of("primary_air")] *= 1.35; });
  const auto& name = shipped()[20].record.inputs.name;

  EXPECT_THAT(findings, found("far_input", name, "primary_air"));
  EXPECT_THAT(findings_on(findings, name),
              Contains(Field(&Finding::message, HasSubstr(" kg/s is usual with these other inputs"))));
}

TEST(Check, AMistakeInEveryCaseIsSeenByPhysics) {
  auto cases = shipped();
  for (auto& one : cases) one.values.row(row_of(one, "pressure")) *= 1e3f;

  const auto findings = check(cases);

  const auto n =
      std::count_if(findings.begin(), findings.end(), [](const Finding& f) { return f.kind == "far_input"; });
  EXPECT_EQ(n, static_cast<std::ptrdiff_t>(cases.size()));
  EXPECT_THAT(findings, Contains(Field(&Finding::quantity, HasSubstr("weight of the solids"))));
}

TEST(Check, ASingleCaseIsJudgedByPhysics) {
  auto one = shipped()[0];
  one.record.inputs.values[one.schema.index_of("solids_d50")] *= 1e3;

  EXPECT_THAT(check({one}), Contains(Field(&Finding::quantity, HasSubstr("solids' size"))));
}

/// Cases of one input without a unit, with what `input` makes of even shares of (0, 1).
template <class Input>
std::vector<CaseSummary> designed(std::size_t n, Input input) {
  std::vector<CaseSummary> cases(n);
  for (std::size_t i = 0; i < n; ++i) {
    cases[i].schema = field::InputSchema({{"skew", "1", "1"}});
    cases[i].inputs = {input((static_cast<double>(i) + 0.3) / static_cast<double>(n))};
    cases[i].measures.fill(std::numeric_limits<double>::quiet_NaN());
  }
  return cases;
}

TEST(UnitMistakes, AnInputSpreadEvenlyFromZeroHasNone) {
  for (const std::size_t n : {20u, 80u, 200u}) {
    const auto even = designed(n, [](double share) { return 1.2 * share; });

    EXPECT_THAT(find_unit_mistakes(even), IsEmpty()) << n;
  }
}

TEST(UnitMistakes, AreToldWhereAnInputHasALowerEnd) {
  auto even = designed(80, [](double share) { return 0.4 + share; });
  auto decade = designed(80, [](double share) { return std::pow(10, share); });
  for (auto* cases : {&even, &decade}) {
    (*cases)[40].inputs[0] *= 0.01;

    const auto mistakes = find_unit_mistakes(*cases);

    ASSERT_EQ(mistakes.size(), 1);
    EXPECT_EQ(mistakes[0].i_case, 40);
    EXPECT_TRUE(mistakes[0].certain_cause);
  }
}

TEST(UnitMistakes, AMeasureOfAnySignHasNone) {
  auto cases = designed(60, [](double) { return 1.0; });
  const auto drop = static_cast<std::size_t>(Measure::pressure_drop);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    cases[i].fields = {"pressure"};
    cases[i].measures[drop] = std::exp(static_cast<double>(i) / 15) - 1.2;  // three below 0, then 0.02 Pa
  }
  EXPECT_THAT(find_unit_mistakes(cases), IsEmpty());

  for (auto& one : cases) one.measures[drop] += 1.2;
  cases[3].measures[drop] /= 100;
  EXPECT_EQ(find_unit_mistakes(cases).size(), 1);
}

TEST(Twins, AreNearerThanManyCasesOfOneInputAre) {
  auto cases = designed(300, [](double share) { return share; });
  for (auto& one : cases) {
    one.sketch = MatrixF::Constant(1, 2, static_cast<float>(one.inputs[0]));
    one.digest = std::to_string(one.inputs[0]);
  }
  EXPECT_THAT(find_twins(cases), IsEmpty());

  cases.push_back(cases[7]);
  cases.back().sketch *= 1.005F;  // 0.04 % of the usual distance away
  cases.back().digest = "rounded";
  const auto twins = find_twins(cases);
  ASSERT_EQ(twins.size(), 1);
  EXPECT_EQ(twins[0].first, 7);
  EXPECT_FALSE(twins[0].exact);
}

TEST(Check, DuplicatesAndNearDuplicatesAreTold) {
  auto cases = shipped();
  cases.push_back(cases[5]);
  cases.back().record.inputs.name = "copy";
  cases.push_back(cases[9]);
  cases.back().record.inputs.name = "rounded";
  cases.back().values *= 1.0005f;

  const auto findings = check(cases);

  EXPECT_THAT(findings, found("duplicate", "copy", ""));
  EXPECT_THAT(findings, found("near_duplicate", "rounded", ""));
}

TEST(Check, CasesThatLieApartAreTold) {
  const auto swapped = check_with(3, [](CfdCase& one) {
    one.values.row(row_of(one, "gas_velocity_x")).swap(one.values.row(row_of(one, "gas_velocity_z")));
  });
  const auto upside_down =
      check_with(3, [](CfdCase& one) { one.values = one.values.rowwise().reverse().eval(); });
  const auto& name = shipped()[3].record.inputs.name;

  EXPECT_THAT(findings_on(swapped, name), Contains(Field(&Finding::kind, "outlier")));
  EXPECT_THAT(findings_on(upside_down, name), Contains(Field(&Finding::kind, "outlier")));
  EXPECT_THAT(findings_on(swapped, shipped()[4].record.inputs.name), IsEmpty());
}

TEST(Check, FieldsAndInputsThatNeverChangeAreTold) {
  auto cases = std::vector<CfdCase>(shipped().begin(), shipped().begin() + 4);
  for (auto& one : cases) {
    one.values.row(row_of(one, "gas_velocity_x")).setConstant(2);
    one.record.inputs.values[0] = 170;
  }

  const auto findings = check(cases);

  EXPECT_THAT(findings, found("dead_cells", "", "gas_velocity_x"));
  EXPECT_THAT(findings, found("dead_input", "", "primary_air"));
}

TEST(Check, ReportIsJsonWithEveryFinding) {
  Checker checker;
  checker.add(view_of(shipped()[0]));
  checker.add_unreadable("b.h5", "no such dataset");

  const auto text = to_json(checker, checker.findings());

  EXPECT_THAT(text, AllOf(HasSubstr("\"kind\": \"elrom-check\""),
                          HasSubstr("\"" + shipped()[0].record.inputs.name + "\""),
                          HasSubstr("\"case\": \"b.h5\""), HasSubstr("\"wrong\": 1")));
}

}  // namespace
}  // namespace elrom::ingest
