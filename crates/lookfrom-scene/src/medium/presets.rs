//! Scattering media by name, with the names that pbrt-v4 has for them.
//!
//! Jensen et al. 2001, A Practical Model for Subsurface Light Transport, table 1; Narasimhan et al. 2006, Acquiring Scattering
//! Properties of Participating Media by Dilution. Both measured reduced scattering coefficients, which belong to a phase
//! function that is the same in all directions (g = 0).

use crate::material::{Color, SubsurfaceMedium};

/// A measured medium: coefficients in mm⁻¹, for the primaries of Rec. 709.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preset {
    /// Its name in pbrt-v4.
    pub name: &'static str,
    /// The reduced scattering coefficient: with g = 0.
    pub scattering: [f32; 3],
    /// The absorption coefficient.
    pub absorption: [f32; 3],
}

impl Preset {
    /// The medium of this name, if there is one.
    pub fn named(name: &str) -> Option<&'static Self> {
        PRESETS.iter().find(|preset| preset.name == name)
    }

    /// All of them.
    pub fn all() -> &'static [Self] {
        PRESETS
    }
}

impl From<&Preset> for SubsurfaceMedium {
    fn from(preset: &Preset) -> Self {
        Self::Coefficients {
            absorption: Color::Value(preset.absorption),
            scattering: Color::Value(preset.scattering),
        }
    }
}

const fn measured(name: &'static str, scattering: [f32; 3], absorption: [f32; 3]) -> Preset {
    Preset { name, scattering, absorption }
}

const PRESETS: &[Preset] = &[
    // Jensen et al.
    measured("Apple", [2.29, 2.39, 1.97], [0.003, 0.0034, 0.046]),
    measured("Chicken1", [0.15, 0.21, 0.38], [0.015, 0.077, 0.19]),
    measured("Chicken2", [0.19, 0.25, 0.32], [0.018, 0.088, 0.2]),
    measured("Cream", [7.38, 5.47, 3.15], [0.0002, 0.0028, 0.0163]),
    measured("Ketchup", [0.18, 0.07, 0.03], [0.061, 0.97, 1.45]),
    measured("Marble", [2.19, 2.62, 3.0], [0.0021, 0.0041, 0.0071]),
    measured("Potato", [0.68, 0.7, 0.55], [0.0024, 0.009, 0.12]),
    measured("Skimmilk", [0.7, 1.22, 1.9], [0.0014, 0.0025, 0.0142]),
    measured("Skin1", [0.74, 0.88, 1.01], [0.032, 0.17, 0.48]),
    measured("Skin2", [1.09, 1.59, 1.79], [0.013, 0.07, 0.145]),
    measured("Spectralon", [11.6, 20.4, 14.9], [0.0, 0.0, 0.0]),
    measured("Wholemilk", [2.55, 3.21, 3.77], [0.0011, 0.0024, 0.014]),
    // Narasimhan et al.
    measured("Lowfat Milk", [0.891_87, 1.5136, 2.532], [0.002_875, 0.005_75, 0.0115]),
    measured("Reduced Milk", [2.4858, 3.1669, 4.5214], [0.002_555_6, 0.005_111_1, 0.012_778]),
    measured("Regular Milk", [4.5513, 5.8294, 7.136], [0.001_533_3, 0.0046, 0.019_933]),
    measured("Espresso", [0.723_78, 0.845_57, 1.0247], [4.7984, 6.5751, 8.8493]),
    measured("Mint Mocha Coffee", [0.316_02, 0.385_38, 0.481_31], [3.772, 5.8228, 7.82]),
    measured("Lowfat Soy Milk", [0.305_76, 0.342_33, 0.616_64], [0.001_437_5, 0.007_187_5, 0.035_937]),
    measured("Regular Soy Milk", [0.592_23, 0.738_66, 1.4693], [0.001_916_7, 0.009_583_3, 0.065_167]),
    measured("Lowfat Chocolate Milk", [0.649_25, 0.839_16, 1.1057], [0.0115, 0.0368, 0.1564]),
    measured("Regular Chocolate Milk", [1.4585, 2.1289, 2.9527], [0.010_063, 0.043_125, 0.143_75]),
    measured("Coke", [8.9053e-5, 8.372e-5, 0.0], [0.100_14, 0.165_03, 0.2468]),
    measured("Pepsi", [6.1697e-5, 4.2564e-5, 0.0], [0.091_641, 0.141_58, 0.207_29]),
    measured("Sprite", [6.0306e-6, 6.4139e-6, 6.5504e-6], [0.001_886, 0.001_830_8, 0.002_002_5]),
    measured("Gatorade", [0.002_457_4, 0.003_007, 0.003_732_5], [0.024_794, 0.019_289, 0.008_878]),
    measured("Chardonnay", [1.7982e-5, 1.3758e-5, 1.2023e-5], [0.010_782, 0.011_855, 0.023_997]),
    measured("White Zinfandel", [1.7501e-5, 1.9069e-5, 1.288e-5], [0.012_072, 0.016_184, 0.019_843]),
    measured("Merlot", [2.1129e-5, 0.0, 0.0], [0.116_32, 0.251_91, 0.294_34]),
    measured("Budweiser Beer", [2.4356e-5, 2.4079e-5, 1.0564e-5], [0.011_492, 0.024_911, 0.057_786]),
    measured("Coors Light Beer", [5.0922e-5, 4.301e-5, 0.0], [0.006_164, 0.013_984, 0.034_983]),
    measured("Clorox", [0.002_403_5, 0.003_137_3, 0.003_991], [0.003_354_2, 0.014_892, 0.026_297]),
    measured("Apple Juice", [0.000_136_12, 0.000_158_36, 0.000_227], [0.012_957, 0.023_741, 0.052_184]),
    measured("Cranberry Juice", [0.000_104_02, 0.000_116_46, 7.8139e-5], [0.039_437, 0.094_223, 0.124_26]),
    measured("Grape Juice", [5.382e-5, 0.0, 0.0], [0.104_04, 0.239_58, 0.293_25]),
    measured("Ruby Grapefruit Juice", [0.011_002, 0.010_927, 0.011_036], [0.085_867, 0.183_14, 0.252_62]),
    measured("White Grapefruit Juice", [0.228_26, 0.239_98, 0.327_48], [0.0138, 0.018_831, 0.056_781]),
    measured("Shampoo", [0.000_717_6, 0.000_830_3, 0.000_901_6], [0.014_107, 0.045_693, 0.061_717]),
    measured("Strawberry Shampoo", [0.000_156_71, 0.000_159_47, 1.518e-5], [0.014_49, 0.057_96, 0.075_823]),
    measured("Head & Shoulders Shampoo", [0.023_805, 0.028_804, 0.034_306], [0.084_621, 0.156_88, 0.203_65]),
    measured("Lemon Tea Powder", [0.040_224, 0.045_264, 0.051_081], [2.4288, 4.5757, 7.2127]),
    measured("Orange Powder", [0.000_156_17, 0.000_174_82, 0.000_176_2], [0.001_449, 0.003_441, 0.007_863]),
    measured(
        "Pink Lemonade Powder",
        [0.000_121_03, 0.000_130_73, 0.000_125_28],
        [0.001_165, 0.002_366, 0.003_195],
    ),
    measured("Cappuccino Powder", [1.8436, 2.5851, 2.1662], [35.844, 49.547, 61.084]),
    measured("Salt Powder", [0.027_333, 0.032_451, 0.031_979], [0.284_15, 0.3257, 0.341_48]),
    measured("Sugar Powder", [0.000_222_72, 0.000_255_13, 0.000_271], [0.012_638, 0.031_051, 0.050_124]),
    measured("Suisse Mocha Powder", [2.7979, 3.5452, 4.3365], [17.502, 27.004, 35.433]),
    measured(
        "Pacific Ocean Surface Water",
        [0.000_176_4, 0.000_320_95, 0.000_196_17],
        [0.031_845, 0.031_324, 0.030_147],
    ),
];
