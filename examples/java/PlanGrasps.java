// Asks a running boxgrasp-server for grasps:  PlanGrasps CLOUD.xyz   (three numbers a line, metres)
//
//   lcm-gen --java --jpath types /usr/share/boxgrasp/lcmtypes/*.lcm
//   sed -i -E 's/, (this\.)?data_size\)/, (int) this.data_size)/' types/drake/lcmt_point_cloud.java   # lcm-gen forgets the cast
//   javac -cp /usr/share/java/lcm.jar:types -d out PlanGrasps.java $(find types -name '*.java')
//   java -cp /usr/share/java/lcm.jar:out PlanGrasps CLOUD.xyz
import boxgrasp.plan_request_t;
import boxgrasp.plan_response_t;
import drake.lcmt_point_cloud;
import drake.lcmt_point_cloud_field;
import java.nio.ByteBuffer;
import java.nio.ByteOrder;
import java.nio.file.Files;
import java.nio.file.Path;
import java.util.UUID;
import java.util.concurrent.LinkedBlockingQueue;
import java.util.concurrent.TimeUnit;
import lcm.lcm.LCM;

public class PlanGrasps {
  static lcmt_point_cloud pointCloud(Path file) throws Exception {
    String[][] rows = Files.lines(file).filter(line -> !line.isBlank() && line.charAt(0) != '#')
                          .map(line -> line.trim().split("\\s+")).toArray(String[][]::new);
    ByteBuffer data = ByteBuffer.allocate(12 * rows.length).order(ByteOrder.LITTLE_ENDIAN);
    for (String[] row : rows)
      for (int i = 0; i < 3; ++i) data.putFloat(Float.parseFloat(row[i]));
    lcmt_point_cloud cloud = new lcmt_point_cloud();
    cloud.frame_name = "camera";
    cloud.width = rows.length;
    cloud.height = 1;
    cloud.num_fields = 3;
    cloud.fields = new lcmt_point_cloud_field[3];
    for (int i = 0; i < 3; ++i) {
      cloud.fields[i] = new lcmt_point_cloud_field();
      cloud.fields[i].name = "xyz".substring(i, i + 1);
      cloud.fields[i].byte_offset = 4 * i;
      cloud.fields[i].datatype = lcmt_point_cloud_field.FLOAT32;
      cloud.fields[i].count = 1;
    }
    cloud.point_step = 12;
    cloud.row_step = data.capacity();
    cloud.filler = new byte[0];
    cloud.data_size = data.capacity();
    cloud.data = data.array();
    return cloud;
  }

  public static void main(String[] arguments) throws Exception {
    plan_request_t request = new plan_request_t();
    request.utime = System.currentTimeMillis() * 1000;
    request.request_id = UUID.randomUUID().toString();
    request.cloud = pointCloud(Path.of(arguments[0]));
    request.object = -1;
    request.top_k = 5;
    LCM lcm = new LCM("udpm://239.255.76.67:7667?ttl=0");
    LinkedBlockingQueue<plan_response_t> answers = new LinkedBlockingQueue<>();
    lcm.subscribe("BOXGRASP_PLAN_RESPONSE", (bus, channel, input) -> {
      try {
        plan_response_t answer = new plan_response_t(input);
        if (answer.request_id.equals(request.request_id)) answers.add(answer);
      } catch (java.io.IOException error) {
        System.err.println("a message that is no answer: " + error.getMessage());
      }
    });
    // LCM may lose messages: the same id is planned once, however often it is sent.
    plan_response_t answer = null;
    for (int attempt = 0; attempt < 10 && answer == null; ++attempt) {
      lcm.publish("BOXGRASP_PLAN_REQUEST", request);
      answer = answers.poll(2, TimeUnit.SECONDS);
    }
    System.err.println(answer == null ? "no server answers" : answer.message);
    if (answer != null)
      for (boxgrasp.grasp_t grasp : answer.grasps)
        System.out.printf("score %.3f  palm at %.4f %.4f %.4f m%n", grasp.score, grasp.palm_position_m[0],
                          grasp.palm_position_m[1], grasp.palm_position_m[2]);
    System.exit(answer == null ? 4 : answer.num_grasps > 0 ? 0 : 1);
  }
}
