//! The serial line of the link: USART3 at 115200 baud, 8 bits, no parity, both ways by DMA.
//!
//! The USART has one data register and no FIFO, and control holds the core for a third of each millisecond, in which
//! four bytes come. So a DMA stream takes every byte as it comes, into a ring that the line's task empties once a
//! millisecond. Only the stream reads the data register: the HAL's own ring also reads it with the core, to find an
//! idle line (embassy-stm32 0.6.0, `usart/ringbuffered.rs`), and can take away a byte that has just come. Noise,
//! framing and overrun errors have no interrupt here and do not stop the stream (RM0090, 30.3.13); a frame with a wrong
//! byte has a wrong check.

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

/// Pins' function that is USART3.
const FUNCTION: u8 = 7;

/// Bytes that wait to be taken. The task does not look while it sends; a telemetry frame takes 11.5 ms at 115200 baud,
/// the longest answer 29 ms. Meanwhile at most one request of 332 bytes comes from a host that waits for answers; from
/// one that does not, this is 22 ms at 921600 baud, 178 ms at 115200.
const WAITING: usize = 2048;

/// How often the task looks for bytes.
const LOOK: Duration = Duration::from_millis(1);

type Half<T> = Mutex<CriticalSectionRawMutex, Option<T>>;
static RX: Half<ReadableRingBuffer<'static, u8>> = Mutex::new(None);
static TX: Half<UartTx<'static, mode::Async>> = Mutex::new(None);

/// Opens the line; without it [`read`] and [`write`] never end.
///
/// # Panics
/// When called a second time.
pub(super) fn start(link: Link) {
    static RECEIVED: ConstStaticCell<[u8; WAITING]> = ConstStaticCell::new([0; WAITING]);
    let mut config = Config::default();
    config.baudrate = 115_200;
    let Ok(to) = UartTx::new(link.uart, link.tx, link.tx_stream, Streams, config) else { return };
    // Pulled up, so that a port without a plug is quiet.
    alternate(link.rx, FUNCTION, AfType::input(Pull::Up));
    let request = link.rx_stream.request();
    let stream = Channel::new(link.rx_stream, Streams);
    let register = pac::USART3.dr().as_ptr().cast();
    // SAFETY: the ring lives for ever, nothing else touches its memory, and the register is the USART's.
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

/// Waits for bytes; how many came. A ring that ran over begins anew: the frames in it are lost.
pub async fn read(into: &mut [u8]) -> usize {
    let mut rx = RX.lock().await;
    let Some(ring) = rx.as_mut() else { core::future::pending().await };
    loop {
        if let Ok((taken @ 1.., _)) = ring.read(into) {
            return taken;
        }
        Timer::after(LOOK).await;
    }
}

/// Waits until all bytes are on their way.
pub async fn write(bytes: &[u8]) {
    match TX.lock().await.as_mut() {
        // The HAL gives no error here.
        Some(tx) => tx.write(bytes).await.unwrap_or(()),
        None => core::future::pending().await,
    }
}
