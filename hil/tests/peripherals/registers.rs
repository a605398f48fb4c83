//! Addresses and bits that the tests use, by their names in the reference manual.

pub const FLASH: u32 = 0x4002_3C00;
pub const FLASH_ACR: u32 = FLASH;
pub const FLASH_KEYR: u32 = FLASH + 0x04;
pub const FLASH_OPTKEYR: u32 = FLASH + 0x08;
pub const FLASH_SR: u32 = FLASH + 0x0C;
pub const FLASH_CR: u32 = FLASH + 0x10;
pub const FLASH_OPTCR: u32 = FLASH + 0x14;

pub const PWR_CR: u32 = 0x4000_7000;
pub const PWR_CSR: u32 = 0x4000_7004;

pub const RCC: u32 = 0x4002_3800;
pub const RCC_CR: u32 = RCC;
pub const RCC_PLLCFGR: u32 = RCC + 0x04;
pub const RCC_CFGR: u32 = RCC + 0x08;
pub const RCC_CIR: u32 = RCC + 0x0C;
pub const RCC_AHB1RSTR: u32 = RCC + 0x10;
pub const RCC_APB1RSTR: u32 = RCC + 0x20;
pub const RCC_APB2RSTR: u32 = RCC + 0x24;
pub const RCC_AHB1ENR: u32 = RCC + 0x30;
pub const RCC_APB1ENR: u32 = RCC + 0x40;
pub const RCC_APB2ENR: u32 = RCC + 0x44;
pub const RCC_BDCR: u32 = RCC + 0x70;
pub const RCC_CSR: u32 = RCC + 0x74;

pub const HSION: u32 = 1;
pub const HSEON: u32 = 1 << 16;
pub const HSERDY: u32 = 1 << 17;
pub const PLLON: u32 = 1 << 24;
/// 8 MHz crystal / 4 * 168 / 2.
pub const PLL_168_MHZ: u32 = 4 | 168 << 6 | 1 << 22 | 7 << 24;
/// SW = PLL, APB1 divided by four, APB2 by two.
pub const CFGR_168_MHZ: u32 = 2 | 5 << 10 | 4 << 13;

pub const GPIOA: u32 = 0x4002_0000;
pub const GPIOB: u32 = 0x4002_0400;
pub const GPIOC: u32 = 0x4002_0800;
pub const MODER: u32 = 0x00;
pub const OTYPER: u32 = 0x04;
pub const PUPDR: u32 = 0x0C;
pub const IDR: u32 = 0x10;
pub const ODR: u32 = 0x14;
pub const BSRR: u32 = 0x18;
pub const LCKR: u32 = 0x1C;
pub const AFRL: u32 = 0x20;

pub const SYSCFG: u32 = 0x4001_3800;
pub const EXTICR1: u32 = SYSCFG + 0x08;
pub const EXTICR2: u32 = SYSCFG + 0x0C;
pub const EXTI: u32 = 0x4001_3C00;
pub const IMR: u32 = EXTI;
pub const RTSR: u32 = EXTI + 0x08;
pub const FTSR: u32 = EXTI + 0x0C;
pub const SWIER: u32 = EXTI + 0x10;
pub const PR: u32 = EXTI + 0x14;

pub const SPI1: u32 = 0x4001_3000;
pub const SPI_CR1: u32 = SPI1;
pub const SPI_CR2: u32 = SPI1 + 0x04;
pub const SPI_SR: u32 = SPI1 + 0x08;
pub const SPI_DR: u32 = SPI1 + 0x0C;

pub const ADC1: u32 = 0x4001_2000;
pub const ADC_SR: u32 = ADC1;
pub const ADC_CR1: u32 = ADC1 + 0x04;
pub const ADC_CR2: u32 = ADC1 + 0x08;
pub const ADC_SMPR1: u32 = ADC1 + 0x0C;
pub const ADC_SQR1: u32 = ADC1 + 0x2C;
pub const ADC_SQR3: u32 = ADC1 + 0x34;
pub const ADC_DR: u32 = ADC1 + 0x4C;
pub const ADC_CCR: u32 = ADC1 + 0x304;

pub const I2C1: u32 = 0x4000_5400;
pub const I2C_CR1: u32 = I2C1;
pub const I2C_CR2: u32 = I2C1 + 0x04;
pub const I2C_DR: u32 = I2C1 + 0x10;
pub const I2C_SR1: u32 = I2C1 + 0x14;
pub const I2C_SR2: u32 = I2C1 + 0x18;
pub const I2C_CCR: u32 = I2C1 + 0x1C;
pub const I2C_TRISE: u32 = I2C1 + 0x20;

pub const USART1: u32 = 0x4001_1000;
pub const USART3: u32 = 0x4000_4800;
pub const SR: u32 = 0x00;
pub const DR: u32 = 0x04;
pub const BRR: u32 = 0x08;
pub const CR1: u32 = 0x0C;
pub const CR2: u32 = 0x10;
pub const CR3: u32 = 0x14;

pub const DMA1: u32 = 0x4002_6000;
pub const DMA2: u32 = 0x4002_6400;
pub const LISR: u32 = 0x00;
pub const HISR: u32 = 0x04;
pub const LIFCR: u32 = 0x08;
pub const HIFCR: u32 = 0x0C;

pub const TIM1: u32 = 0x4001_0000;
pub const TIM2: u32 = 0x4000_0000;
pub const TIM3: u32 = 0x4000_0400;
pub const TIM6: u32 = 0x4000_1000;
pub const TIM_CR1: u32 = 0x00;
pub const TIM_DIER: u32 = 0x0C;
pub const TIM_SR: u32 = 0x10;
pub const TIM_EGR: u32 = 0x14;
pub const TIM_CCMR1: u32 = 0x18;
pub const TIM_CCMR2: u32 = 0x1C;
pub const TIM_CCER: u32 = 0x20;
pub const TIM_CNT: u32 = 0x24;
pub const TIM_PSC: u32 = 0x28;
pub const TIM_ARR: u32 = 0x2C;
pub const TIM_CCR1: u32 = 0x34;
pub const TIM_CCR2: u32 = 0x38;
pub const TIM_CCR3: u32 = 0x3C;
pub const TIM_BDTR: u32 = 0x44;

pub const IWDG_KR: u32 = 0x4000_3000;
pub const IWDG_PR: u32 = 0x4000_3004;
pub const IWDG_RLR: u32 = 0x4000_3008;
pub const IWDG_SR: u32 = 0x4000_300C;

pub const BKP0R: u32 = 0x4000_2850;
