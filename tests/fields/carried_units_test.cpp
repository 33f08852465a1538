// Units that elrom-predict does not know by itself: the bundle brings them. The program is a process of its
// own, which no unit that this test knows can reach otherwise.
#include <gmock/gmock.h>
#include <sys/wait.h>

#include <cstdlib>

#include "elrom/base/units.hpp"
#include "elrom/io/hdf5.hpp"
#include "support/sample_bundle.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::fields {
namespace {

class CarriedUnits : public ::testing::Test {
 protected:
  void SetUp() override {
    base::know_unit({"kW/m2", "W/m2", 1e3});
    auto bundle = test::sample_bundle();
    auto inputs = bundle.info.schema.inputs();
    inputs[0] = {"heat_flux", "W/m2", "kW/m2"};
    bundle.info.schema = field::InputSchema(inputs);
    bundle.write(folder_ / "model.elrom");
  }

  /// elrom-predict on one case, whose first heading and value are given. @return exit status
  [[nodiscard]] int predict(const std::string& name, const std::string& heading, const std::string& value,
                            const std::string& more = "") const {
    test::write_bytes(folder_ / (name + ".csv"), "case," + heading +
                                                     ",flow_1 [kg/s],flow_2 [kg/s],flow_3 [kg/s]\n" + name +
                                                     "," + value + ",14,21,28\n");
    const auto path = [&](const std::string& file) { return " '" + (folder_ / file).string() + "' "; };
    const int status =
        std::system((ELROM_BIN_DIR "/elrom-predict --bundle" + path("model.elrom") + "--cases" +
                     path(name + ".csv") + "--output" + path("out") + more + " >" + path("said") + "2>&1")
                        .c_str());
    return WEXITSTATUS(status);
  }
  [[nodiscard]] std::vector<float> pressure(const std::string& name) const {
    return io::Hdf5File::open(folder_ / ("out/" + name + ".hdf"))
        .dataset("elrom/fields/pressure")
        .read<float>();
  }

  const test::TemporaryFolder folder_;
};

TEST_F(CarriedUnits, AreConvertedInTablesAndSettings) {
  ASSERT_EQ(predict("shown", "heat_flux [kW/m2]", "0.007"), 0) << test::read_bytes(folder_ / "said");
  ASSERT_EQ(predict("si", "heat_flux [W/m2]", "7"), 0) << test::read_bytes(folder_ / "said");
  ASSERT_EQ(predict("set", "heat_flux [W/m2]", "1", "--name set --set 'heat_flux=0.007 kW/m2'"), 0);
  ASSERT_EQ(predict("other", "heat_flux [kW/m2]", "7"), 0);

  EXPECT_EQ(pressure("shown"), pressure("si"));
  EXPECT_EQ(pressure("set"), pressure("si"));
  EXPECT_NE(pressure("other"), pressure("si"));
}

TEST_F(CarriedUnits, OfAnotherInputAreRefused) {
  EXPECT_EQ(predict("a", "heat_flux [kg/s]", "7"), 3);
  EXPECT_THAT(test::read_bytes(folder_ / "said"), ::testing::HasSubstr("expected one of W/m2, kW/m2"));
}

}  // namespace
}  // namespace elrom::fields
