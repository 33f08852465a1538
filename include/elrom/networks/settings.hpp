#pragma once
// What the training of networks can be told; study/settings.hpp reads it from study.toml, with every default
// and meaning in one table.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "elrom/field/symmetry.hpp"

namespace elrom::networks {

struct SplitSettings {
  /// Names or patterns of cases never built with; nothing: those of the store's furnace.
  std::optional<std::vector<std::string>> held_out;
  std::string by = "case";                       ///< "case" | "record" (leaks; to show that it does)
  std::vector<double> fractions{0.7, 0.2, 0.1};  ///< train, validation, test
};

struct SymmetrySettings {
  bool enabled = true;
  /// Empty: those of the store's furnace, where schema and mesh allow.
  std::vector<field::MirrorDeclaration> mirrors;
};

/// The default network that is built for every column, and the closed-form screen beside it.
struct ScreenSettings {
  std::string method = "networks";  ///< "networks" | "fast"
  int builds = 5;
  int n_units = 16;
  int batch_size = 64;
  int epoch_records = 4096;  ///< of one epoch at most; 0: all
  double learning_rate = 4e-3;
  int max_epochs = 60;
  int patience = 6;
  int features = 384;  ///< random features of the fast screen
};

struct BandSettings {
  std::string scope = "field";  ///< "field" | "plane"
  std::vector<double> edges{0.1, 0.2, 0.3, 0.5};
};

struct SearchSettings {
  std::string algorithm = "direct";  ///< "direct" | "sobol_bobyqa" | "sbplx" | "crs2" | "random"
  int trials = 50;
  bool prune = true;      ///< ASHA
  int confirm = 5;        ///< best trials that are built again ...
  int confirm_seeds = 3;  ///< ... with so many seeds
  int max_epochs = 60;
  int patience = 8;
  std::vector<double> learning_rate{3e-4, 2e-2};
  std::vector<double> n_layers{1, 3};
  std::vector<double> n_units{16, 256};
  std::vector<double> batch_size{32, 256};
  std::vector<double> weight_decay{1e-6, 1e-1};  ///< searched when search.regularise is on
  std::vector<double> dropout{0.0, 0.3};
  bool regularise = false;  ///< search weight_decay and dropout too
};

struct FitSettings {
  int builds = 5;                ///< each stops on a fold of cases of its own
  std::string combine = "mean";  ///< "mean" | "best" (the source)
  int max_epochs = 200;
  int patience = 20;
};

struct NetworkSettings {
  std::string plane_encoding = "fourier";  ///< "index" (the source) | "fourier" | "one_hot"
  std::string activation = "relu";
  std::string targets = "column";   ///< "column" (eq. 6.1) | "cell": mean and scale of every cell on its own
  int epoch_records = 12288;        ///< of one epoch at most, about what 190 cases have; 0: all
  std::string schedule = "cosine";  ///< of the learning rate: "cosine" | "constant" (the source)
  bool mirrors = true;              ///< learn the symmetric part over its scale, on one column of each orbit
  bool average = false;  ///< average the answers for a case and its mirror images (without mirrors above)
  std::string relevance = "gp";  ///< inputs scaled by "gp": length scales | "linear": a ridge fit | "none"
  std::map<std::string, std::string> transform;  ///< field -> none (where not named) | log | asinh
};

/// Everything a fitted network depends on; threads, device and paths are not among them.
struct Settings {
  SplitSettings split;
  SymmetrySettings symmetry;
  ScreenSettings screen;
  BandSettings bands;
  SearchSettings search;
  FitSettings fit;
  NetworkSettings networks;
};

}  // namespace elrom::networks
