//! Serial port of the link: USART3 at 115200 baud, 8 bits, no parity, DMA in both directions.
//!
//! The USART has one data register and no FIFO, and control occupies the core for a third of each millisecond, in
//! which four bytes arrive. So a DMA stream stores every byte in a ring that the link's task empties once per
//! millisecond. Only the stream reads the data register: the HAL's ring also reads it with the core, to detect an
//! idle line (embassy-stm32 0.6.0, `usart/ringbuffered.rs`), and can discard a byte. Noise, framing and overrun
//! errors have no interrupt here and do not stop the stream (RM0090, 30.3.13); the CRC rejects frames with wrong bytes.

use super::pins::{Link, alternate};
use embassy_stm32::dma::{Channel, InterruptHandler, ReadableRingBuffer, TransferOptions};
use embassy_stm32::gpio::{AfType, Pull};
use embassy_stm32::pac;
use embassy_stm32::peripherals::{DMA1_CH1, DMA1_CH3};
use embassy_stm32::usart::{Config, RxDma, UartTx};
use embassy_stm32::{bind_interrupts, mode};
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::mutex::Mutex;
use embassy_time::{Duration, Timer};
use static_cell::ConstStaticCell;

bind_interrupts!(struct Streams {
    DMA1_STREAM1 => InterruptHandler<DMA1_CH1>;
    DMA1_STREAM3 => InterruptHandler<DMA1_CH3>;
});

/// Alternate function of USART3.
const FUNCTION: u8 = 7;

/// Size of the receive ring \[bytes\]. The task does not read while it sends; a telemetry frame takes 11.5 ms at 115200
/// baud, the longest answer 29 ms. Meanwhile a host that waits for answers sends at most one request of 332 bytes;
/// for one that does not, the ring lasts 22 ms at 921600 baud, 178 ms at 115200.
const WAITING: usize = 2048;

/// Polling period of the task.
const POLL_PERIOD: Duration = Duration::from_millis(1);

type Half<T> = Mutex<CriticalSectionRawMutex, Option<T>>;
static RX: Half<ReadableRingBuffer<'static, u8>> = Mutex::new(None);
static TX: Half<UartTx<'static, mode::Async>> = Mutex::new(None);

/// Opens the port; before that [`read`] and [`write`] never return.
///
/// # Panics
/// When called a second time.
pub(super) fn start(link: Link) {
    static RECEIVED: ConstStaticCell<[u8; WAITING]> = ConstStaticCell::new([0; WAITING]);
    let mut config = Config::default();
    config.baudrate = 115_200;
    let Ok(to) = UartTx::new(link.uart, link.tx, link.tx_stream, Streams, config) else { return };
    // Pull-up, so that an open port is idle.
    alternate(link.rx, FUNCTION, AfType::input(Pull::Up));
    let request = link.rx_stream.request();
    let stream = Channel::new(link.rx_stream, Streams);
    let register = pac::USART3.dr().as_ptr().cast();
    // SAFETY: the ring is static, nothing else uses its memory, and the register is the USART's.
    let mut from = unsafe {
        ReadableRingBuffer::new(stream, request, register, RECEIVED.take(), TransferOptions::default())
    };
    from.start();
    pac::USART3.cr3().modify(|w| w.set_dmar(true));
    pac::USART3.cr1().modify(|w| w.set_re(true));
    if let (Ok(mut tx), Ok(mut rx)) = (TX.try_lock(), RX.try_lock()) {
        (*tx, *rx) = (Some(to), Some(from));
    }
}

/// Waits for bytes; returns their number. After an overrun the ring is reset: the frames in it are lost.
pub async fn read(into: &mut [u8]) -> usize {
    let mut rx = RX.lock().await;
    let Some(ring) = rx.as_mut() else { core::future::pending().await };
    loop {
        if let Ok((taken @ 1.., _)) = ring.read(into) {
            return taken;
        }
        Timer::after(POLL_PERIOD).await;
    }
}

/// Waits until all bytes are passed to DMA.
pub async fn write(bytes: &[u8]) {
    match TX.lock().await.as_mut() {
        // The HAL returns no error here.
        Some(tx) => tx.write(bytes).await.unwrap_or(()),
        None => core::future::pending().await,
    }
}
